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

/// `text` as it may stand in a cell: on one line and, in Markdown, without column marks.
std::string cell_text(const std::string& text, TableStyle style) {
    std::string cell;
    for (const char c : text) {
        if (c == '|' && style == TableStyle::markdown) cell += '\\';
        cell += c == '\n' || c == '\r' ? ' ' : c;
    }
    return cell;
}

/// Without blanks at the end of the line.
std::string line_of(std::string line) {
    line.erase(line.find_last_not_of(' ') + 1);
    return line + '\n';
}

}  // namespace

std::string counted(std::size_t number, const std::string& what) {
    return std::to_string(number) + " " + what + (number == 1 ? "" : "s");
}

std::string render(const TextTable& table, TableStyle style) {
    const bool markdown = style == TableStyle::markdown;
    std::vector<std::vector<std::string>> lines(1);
    for (const auto& column : table.columns) lines[0].push_back(cell_text(column.header, style));
    for (const auto& row : table.rows) {
        auto& line = lines.emplace_back();
        for (const std::string& cell : row) line.push_back(cell_text(cell, style));
    }
    std::vector<std::size_t> widths(table.columns.size(), markdown ? 3 : 0);
    for (const auto& line : lines) {
        for (std::size_t i = 0; i < line.size(); ++i)
            widths[i] = std::max(widths[i], width(line[i]));
    }

    const auto joined = [&](const std::vector<std::string>& cells) {
        std::string text = markdown ? "|" : "";
        for (std::size_t i = 0; i < cells.size(); ++i) {
            const bool is_left = table.columns[i].align == Align::left;
            const std::string cell =
                fmt::format(fmt::runtime(is_left ? "{:<{}}" : "{:>{}}"), cells[i], widths[i]);
            text += markdown ? " " + cell + " |" : cell + "  ";
        }
        return line_of(std::move(text));
    };
    std::vector<std::string> rule;
    for (std::size_t i = 0; i < widths.size(); ++i) {
        const bool right = markdown && table.columns[i].align == Align::right;
        rule.push_back(std::string(widths[i] - (right ? 1 : 0), '-') + (right ? ":" : ""));
    }

    std::string text = (markdown ? "## " : "") + table.title + "\n" + (markdown ? "\n" : "");
    if (!table.note.empty()) text += table.note + "\n" + (markdown ? "\n" : "");
    text += joined(lines.front()) + joined(rule);
    for (std::size_t i = 1; i < lines.size(); ++i) text += joined(lines[i]);
    return text;
}

std::string render(const std::vector<TextTable>& tables, TableStyle style) {
    std::string text;
    for (const TextTable& table : tables) {
        if (!text.empty()) text += '\n';
        text += render(table, style);
    }
    return text;
}

}  // namespace controlspace
