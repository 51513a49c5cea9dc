#include "study/tables.h"

#include <fmt/format.h>

#include <algorithm>

#include "study/names.h"
#include "study/pareto.h"

namespace controlspace {
namespace {

constexpr double mb = 1e6;  // bytes

constexpr std::string_view absent = "–";

std::vector<std::string> measure_cells(const Row& row) {
    const Case& c = row.setting;
    std::vector<std::string> cells{variant_label(c), std::string(c.split ? name_of(*c.split) : "")};
    if (!row.measures) {
        cells.insert(cells.end(), 12, std::string(absent));
        cells.push_back("failed: " + row.error);
        return cells;
    }
    const Measures& m = *row.measures;
    cells.push_back(m.footprint.leaves > 0 ? fmt::format("{}", m.footprint.leaves)
                                           : std::string(absent));
    cells.push_back(fmt::format("{:.2f}", static_cast<double>(m.footprint.bytes_total()) / mb));
    cells.push_back(fmt::format("{:.3f}", m.insert_s + m.gradation_s));
    cells.push_back(fmt::format("{:.1f}", m.access_random.median_ns()));
    cells.push_back(fmt::format("{:.1f}", m.access_grid.median_ns()));
    cells.push_back(fmt::format("{:.4f}", m.accuracy.max));
    cells.push_back(fmt::format("{:.4f}", m.accuracy.mean));
    cells.push_back(fmt::format("{:.4f}", m.accuracy.p99));
    cells.push_back(fmt::format("{:.4f}", m.accuracy_fine.max));
    const Accuracy& fine = m.accuracy_fine;
    cells.push_back(fmt::format("{:.2f} %", 100 * fine.coarser_share));
    cells.push_back(fmt::format("{:.3f}", fine.coarser_max));
    cells.push_back(fmt::format("{:.4f}", m.gradation.largest_ratio_left));
    cells.push_back(m.footprint.remark);
    return cells;
}

TextTable empty_measure_table(const std::string& title) {
    return {
        title,
        "Fine: at the finer probes. Coarser: share of them where a length asked for exceeds the "
        "reference's by over 1 % in some direction; worst: largest ratio of the two.",
        {{"structure", Align::left},
         {"split", Align::left},
         {"leaves"},
         {"MB"},
         {"creation s"},
         {"random ns"},
         {"grid ns"},
         {"δ_R max"},
         {"δ_R mean"},
         {"δ_R p99"},
         {"fine max"},
         {"fine coarser"},
         {"worst"},
         {"G left"},
         {"remark", Align::left}},
        {}};
}

}  // namespace

std::vector<TextTable> measure_tables(std::span<const Row> rows) {
    std::vector<TextTable> tables;
    for (const Row& row : rows) {
        const std::string title = "All measures: " + setting_label(row.setting);
        auto table = std::find_if(tables.begin(), tables.end(),
                                  [&](const TextTable& t) { return t.title == title; });
        if (table == tables.end()) {
            table = tables.insert(tables.end(), empty_measure_table(title));
        }
        table->rows.push_back(measure_cells(row));
    }
    return tables;
}

std::string render_tables(std::span<const Row> rows, TableStyle style) {
    std::string text;
    const auto add = [&](const std::vector<TextTable>& tables) {
        for (const TextTable& table : tables) {
            if (!text.empty()) text += '\n';
            text += render(table, style);
        }
    };
    add(measure_tables(rows));
    add(pareto_tables(rows));
    return text;
}

}  // namespace controlspace
