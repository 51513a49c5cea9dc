// SPDX-License-Identifier: Apache-2.0
#include "study/text_table.h"

#include <fmt/format.h>

#include <algorithm>

namespace controlspace {
namespace {

/// Number of characters: bytes that do not continue one.
std::size_t width(const std::string& text) {
    return static_cast<std::size_t>(
        std::ranges::count_if(text, [](char c) { return (c & '\xc0') != '\x80'; }));
}

/// `text` as it may stand in a cell: on one line.
std::string cell_text(std::string text) {
    std::ranges::replace_if(
        text, [](char c) { return c == '\n' || c == '\r'; }, ' ');
    return text;
}

}  // namespace

std::string counted(std::size_t number, const std::string& what) {
    return std::to_string(number) + " " + what + (number == 1 ? "" : "s");
}

std::string render(const TextTable& table) {
    std::vector<std::vector<std::string>> lines(1);
    for (const auto& column : table.columns) lines[0].push_back(cell_text(column.header));
    for (const auto& row : table.rows) {
        auto& line = lines.emplace_back();
        for (const std::string& cell : row) line.push_back(cell_text(cell));
    }
    std::vector<std::size_t> widths(table.columns.size());
    for (const auto& line : lines) {
        for (std::size_t i = 0; i < line.size(); ++i) {
            widths[i] = std::max(widths[i], width(line[i]));
        }
    }
    std::vector<std::string> rule;
    rule.reserve(widths.size());
    for (const std::size_t columns : widths) rule.emplace_back(columns, '-');
    lines.insert(lines.begin() + 1, rule);

    std::string text = table.title + "\n";
    if (!table.note.empty()) text += table.note + "\n";
    for (const auto& line : lines) {
        std::string joined;
        for (std::size_t i = 0; i < line.size(); ++i) {
            const bool is_left = table.columns[i].align == Align::left;
            joined +=
                fmt::format(fmt::runtime(is_left ? "{:<{}}  " : "{:>{}}  "), line[i], widths[i]);
        }
        joined.erase(joined.find_last_not_of(' ') + 1);
        text += joined + '\n';
    }
    return text;
}

std::string render(const std::vector<TextTable>& tables) {
    std::string text;
    for (const TextTable& table : tables) {
        if (!text.empty()) text += '\n';
        text += render(table);
    }
    return text;
}

}  // namespace controlspace
