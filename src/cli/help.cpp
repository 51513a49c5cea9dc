// SPDX-License-Identifier: Apache-2.0
#include "cli/help.h"

#include <sys/ioctl.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <memory>
#include <vector>

namespace controlspace {
namespace {

/// In the order of the help; what is not here (of one command, of a format) comes after Output.
constexpr std::pair<Topic, const char*> headings[] = {
    {Topic::sources, "Sources"},
    {Topic::sizes, "Sizes"},
    {Topic::accuracy, "Accuracy"},
    {Topic::output, "Output"},
    {Topic::structures, "Structures"},
    {Topic::performance, "Performance"},
    {Topic::fields, "Continuous fields to test with"},
    {Topic::paper, "The paper's samples and schemes"},
};

constexpr const char* own = "Options";  // CLI11's name of options without a group

std::size_t rank_of(const std::string& group) {
    constexpr std::size_t after_output = 4;
    if (group == own || group == "Meshing") return 0;
    for (std::size_t i = 0; i < std::size(headings); ++i) {
        if (group == headings[i].second) return 2 * (i + 1);
    }
    return 2 * after_output + 1;
}

/// Columns of UTF-8.
std::size_t columns(std::string_view text) {
    return static_cast<std::size_t>(
        std::ranges::count_if(text, [](char c) { return (c & '\xc0') != '\x80'; }));
}

/// Lines as they are, but longer ones wrapped: with a hanging indent where two blanks or more
/// follow a first word, as in a table.
std::string wrapped_lines(const std::string& text, std::size_t width) {
    std::string result;
    std::size_t first = 0;
    while (first < text.size()) {
        const std::size_t end = std::min(text.find('\n', first), text.size());
        const std::string line = text.substr(first, end - first);
        first = end + 1;
        const std::size_t word = line.find_first_not_of(' ');
        const std::size_t gap = word == 0 ? line.npos : line.find("  ", word);
        if (word == line.npos || gap == line.npos) {
            const std::size_t indent = word == line.npos ? 0 : word;
            result += wrapped("", line.substr(indent), indent, width);
        } else {
            const std::size_t column = line.find_first_not_of(' ', gap);
            result += wrapped(line.substr(0, gap), line.substr(column), column, width);
        }
    }
    return result;
}

class Help : public CLI::Formatter {
public:
    std::string make_help(const CLI::App* app, std::string name,
                          CLI::AppFormatMode) const override {
        const std::size_t width = output_width();
        std::string text = wrapped("", app->get_description(), 0, width);
        text += make_usage(app, std::move(name));
        text += make_positionals(app);
        std::vector<std::string> groups = app->get_groups();
        std::ranges::stable_sort(groups, {}, rank_of);
        for (const std::string& group : groups) {
            const auto options = app->get_options([&](const CLI::Option* option) {
                return option->get_group() == group && option->nonpositional();
            });
            if (!options.empty()) text += make_group(group, false, options);
        }
        const auto commands = app->get_subcommands([](const CLI::App*) { return true; });
        if (!commands.empty()) text += "\nSubcommands:\n";
        for (const CLI::App* command : commands) {
            text += wrapped("  " + command->get_name(), command->get_description(), 12, width);
        }
        return text + "\n" + wrapped_lines(app->get_footer(), width);
    }

    std::string make_option(const CLI::Option* option, bool is_positional) const override {
        constexpr std::size_t column = 30, narrow = 10;
        const std::size_t width = output_width();
        return wrapped("  " + make_option_name(option, is_positional) + make_option_opts(option),
                       make_option_desc(option), width < 2 * column ? narrow : column, width);
    }
};

}  // namespace

std::string heading(Topic topic) {
    return std::ranges::find(headings, topic, [](const auto& h) { return h.first; })->second;
}

std::string wrapped(std::string_view label, std::string_view text, std::size_t column,
                    std::size_t width) {
    std::string result(label);
    std::size_t at = columns(label);
    const std::string indent(column, ' ');
    const auto begin_line = [&] {
        if (!result.empty()) result += '\n';
        result += indent;
        at = column;
    };
    if (at + 2 > column && at > 0) {
        begin_line();
    } else {
        result.append(column - at, ' ');
        at = column;
    }
    while (!text.empty()) {
        const std::size_t end = std::min(text.find(' '), text.size());
        const std::string_view word = text.substr(0, end);
        text.remove_prefix(std::min(end + 1, text.size()));
        const std::size_t wide = columns(word);
        if (at > column && at + 1 + wide > width) begin_line();
        if (at > column) {
            result += ' ';
            ++at;
        }
        result += word;
        at += wide;
    }
    const std::size_t last = result.find_last_not_of(' ');
    return result.substr(0, last + 1) + '\n';
}

std::size_t output_width() {
    constexpr std::size_t unknown = 80, least = 40;
    winsize size{};
    if (::ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) != 0 || size.ws_col == 0) return unknown;
    return std::max<std::size_t>(size.ws_col, least);
}

void set_help(CLI::App& app) { app.formatter(std::make_shared<Help>()); }

}  // namespace controlspace
