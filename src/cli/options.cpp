#include "cli/options.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>

#include "study/file_settings.h"
#include "study/settings.h"
#include "study/vdb_settings.h"

namespace controlspace {
namespace {

/// What the help shows as an option's values: "NUMBER", "TEXT,...", "NUMBER x 3".
std::string type_name(ValueType type, std::size_t at_most) {
    const std::string name = type == ValueType::number         ? "NUMBER"
                             : type == ValueType::whole_number ? "COUNT"
                                                               : "TEXT";
    return at_most == 0   ? name + ",..."
           : at_most == 1 ? name
                          : fmt::format("{} x {}", name, at_most);
}

void describe(CLI::Option& option, const OptionText& text) {
    option.option_text(text.value)->required(text.required);
    if (!text.group.empty()) option.group(text.group);
}

}  // namespace

void Options::add(const OptionText& text, bool& value) {
    CLI::Option* flag = command_->add_flag(text.name, value, text.help);
    if (!text.value.empty()) flag->option_text(text.value);
    if (!text.group.empty()) flag->group(text.group);
}

void Options::add(const OptionText& text, double& value) {
    describe(*command_->add_option(text.name, value, text.help), text);
}

void Options::add(const OptionText& text, int& value) {
    describe(*command_->add_option(text.name, value, text.help), text);
}

void Options::add(const OptionText& text, std::filesystem::path& value) {
    describe(*command_->add_option(text.name, value, text.help), text);
}

void Options::add(const OptionText& text, std::vector<std::string>& values, std::size_t at_most) {
    CLI::Option* option = command_->add_option(text.name, values, text.help);
    describe(*option, text);
    // Lists are written with commas: with blanks they would swallow an argument that follows.
    if (at_most == 0) option->delimiter(',')->allow_extra_args(false);
    if (at_most > 0) option->expected(1, static_cast<int>(at_most));
}

void Options::add_setting(std::string_view key, ValueType type, std::size_t at_most,
                          std::string_view help, const SettingValues& default_values,
                          const std::string& group, std::vector<std::string>& words) {
    std::string text(help);
    if (!default_values.empty()) {
        text += fmt::format(" (default: {})", to_string(default_values));
    }
    CLI::Option* option = command_->add_option(option_name(key), words, text);
    option->delimiter(',')->group(group)->option_text(type_name(type, at_most));
    if (at_most > 1) {
        option->expected(static_cast<int>(at_most));
    } else {
        option->allow_extra_args(false);
    }
}

void Options::exclude(const std::string& name, const std::string& other) {
    command_->get_option(name)->excludes(command_->get_option(other));
}

void Options::set_footer(const std::string& text) { command_->footer(text); }

std::vector<std::string> Options::given_of(const std::string& group) const {
    std::vector<std::string> names;
    for (const CLI::Option* option : command_->get_options()) {
        if (option->count() > 0 && option->get_group() == group) {
            names.push_back(option->get_name());
        }
    }
    return names;
}

GivenSettings given_settings(const WordsByKey& given) {
    GivenSettings settings;
    for (const auto& [key, words] : given) {
        if (!words.empty()) settings.emplace_back(key, words);
    }
    return settings;
}

void add_study_input(Options& options, std::filesystem::path& input) {
    options.add(
        {"INPUT", "FILE", "Study file (.toml) or file of sources; left out: the paper's sphere"},
        input);
}

void add_filled_input(Options& options, std::filesystem::path& input) {
    options.add({"INPUT", "FILE",
                 "Study file (.toml), file of sources, or control space (.ctrl); left out: the "
                 "paper's sphere"},
                input);
}

void add_quiet(Options& options, bool& quiet) {
    options.add({"--quiet", "", "No progress on standard error"}, quiet);
}

void add_making_options(Options& options, WordsByKey& given, std::string_view another) {
    const std::string_view without[] = {
        "name",   "access_points", "access_repeats", "probe_grid", "fine_probe_grid",
        "output", "reference",     another};
    Run defaults;
    defaults.structures = {"K_oL"};
    defaults.splits = {SplitRule::middle};
    options.add_settings(run_settings(), defaults, "Settings of the structure (a value each)",
                         given, without);
    options.add_settings(study_settings(), Study{}, "Settings of the study", given, without);
}

void add_reading_options(Options& options, WordsByKey& given) {
    constexpr std::string_view fields[] = {"field_file", "field_grid", "field_density_sizes"};
    const std::string group = "Settings of reading";
    options.add_settings(file_settings(), Study{}, group, given);
    options.add_settings(vdb_settings(), Study{}, group, given, fields);
}

}  // namespace controlspace
