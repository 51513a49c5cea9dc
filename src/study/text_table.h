// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace controlspace {

enum class Align { left, right };

/// A table for the terminal; every row has as many cells as there are columns. Tables in Markdown
/// are made from files of results by bench/tables.
struct TextTable {
    struct Column {
        std::string header;
        Align align = Align::right;
    };
    std::string title;
    std::string note;  ///< a sentence or two under the title; may be empty
    std::vector<Column> columns;
    std::vector<std::vector<std::string>> rows;
};

/// "1 case", "2 cases".
std::string counted(std::size_t number, const std::string& what);

/// Title, note and aligned columns; UTF-8 counts by characters.
std::string render(const TextTable& table);
/// One after the other.
std::string render(const std::vector<TextTable>& tables);

}  // namespace controlspace
