// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <utility>
#include <vector>

#include "controlspace/study/measure.h"
#include "study/text_table.h"

namespace controlspace {

/// A value as its column shows it: "–" for none.
std::string cell_of(const MeasuredValue& value, const Column& column);

/// A table of the measures that have columns, with a line for each of `rows` (pointers), which
/// begins with its `label`. `value_of(measure, row)` is called for rows without an error; that of
/// others stands under the header "remark".
template <class Measures, class Rows, class Label, class ValueOf>
TextTable measure_table(std::string title, std::string note, std::string header,
                        const Measures& measures, const Rows& rows, const Label& label,
                        const ValueOf& value_of) {
    TextTable table{std::move(title), std::move(note), {{std::move(header), Align::left}}, {}};
    for (const auto* row : rows) table.rows.push_back({label(*row)});
    for (const auto& measure : measures) {
        const Column& column = measure.column;
        if (column.header.empty()) continue;
        const bool is_remark = column.header == "remark";
        table.columns.push_back({column.header, is_remark ? Align::left : Align::right});
        auto line = table.rows.begin();
        for (const auto* row : rows) {
            line++->push_back(row->error.empty() ? cell_of(value_of(measure, *row), column)
                              : is_remark        ? "failed: " + row->error
                                                 : cell_of({}, column));
        }
    }
    return table;
}

/// All measures that have columns, one table for each setting.
std::vector<TextTable> measure_tables(std::span<const Row> rows, const StudyRows& columns);

}  // namespace controlspace
