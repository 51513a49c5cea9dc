// SPDX-License-Identifier: Apache-2.0
#include "study/tables.h"

#include <fmt/format.h>

#include "study/grouped.h"

namespace controlspace {
namespace {

using Rows = std::vector<const Row*>;

TextTable table_of(const std::string& setting, const Rows& rows, const StudyRows& columns) {
    return measure_table(
        "All measures: " + setting,
        "δ of isotropic lengths that differ by a factor k is √3(k + 1/k - 2): 0.02 is 1.11, 0.1 is "
        "1.27. Fine: at the finer probes. Within: largest factor there between a requested length "
        "and the reference's, longer or shorter, in any direction. Coarser, finer: share of them "
        "where a requested length is longer, shorter by over 1 %. Access, in ns a query: of "
        "lengths where all is isotropic, otherwise of metrics; in batches at random places and "
        "near the sources (within two of their lengths), and one a call at random places (single). "
        "G_det, G_dir: largest growth of the finished field between places 0.01 to 1 metric length "
        "apart, of "
        "elements' mean length and of any length, as gradation ratios.",
        "structure", columns.measures, rows,
        [&](const Row& row) { return structure_label(row.setting, columns.parameters); },
        [](const Measure& measure, const Row& row) {
            const auto value = row.values.find(measure.key);
            return value != row.values.end() ? value->second : MeasuredValue();
        });
}

}  // namespace

std::string cell_of(const MeasuredValue& value, const Column& column) {
    const auto scaled = [&](double x) {
        return fmt::format(fmt::runtime(column.format), column.scale * x);
    };
    if (const auto* text = std::get_if<std::string>(&value)) return *text;
    if (const auto* x = std::get_if<double>(&value)) return scaled(*x);
    if (const auto* whole = std::get_if<std::int64_t>(&value)) {
        return column.format == "{}" ? fmt::format("{}", *whole)
                                     : scaled(static_cast<double>(*whole));
    }
    return "–";
}

std::vector<TextTable> measure_tables(std::span<const Row> rows, const StudyRows& columns) {
    std::vector<TextTable> tables;
    for (const auto& [setting, members] : grouped(rows, [&](const Row& row) {
             return setting_label(row.setting, columns.parameters);
         })) {
        tables.push_back(table_of(setting, members, columns));
    }
    return tables;
}

}  // namespace controlspace
