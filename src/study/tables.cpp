#include "study/tables.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <utility>

#include "study/names.h"
#include "study/paper_evidence.h"
#include "study/pareto.h"

namespace controlspace {
namespace {

constexpr double mb = 1e6;  // bytes, as in the paper's Table 1

using Pair = PaperEvidence::Cell;

/// How one of the paper's tables is shown.
struct Comparison {
    std::string_view title;
    std::string_view note;
    PaperTable table;
    double unit;  ///< our values are shown in 1 / unit of the paper's unit
    bool ranks;   ///< only ranks can be compared: another machine, another clock
};

constexpr Comparison comparisons[] = {
    {"Table 1: size as published [MB], ours / paper",
     "The paper's own accounting, which counts no metrics in leaf trees: not the memory taken.",
     PaperTable::size, 1, false},
    {"Table 2: creation time [s], ours (rank) / paper (rank)",
     "Ranks in the column; seconds are of different machines and cannot be compared.",
     PaperTable::creation, 1, true},
    {"Table 3: access time, ours [ns] (rank) / paper [µs] (rank)",
     "Ranks in the column; the paper's times are whole ticks of 0.370 µs.", PaperTable::access, 1e3,
     true},
    {"Table 4: largest delta_R, ours / paper",
     "At the centres of 30 x 30 x 30 cells, against the published field of the sphere.",
     PaperTable::delta_r, 1, false},
};

constexpr std::string_view absent = "–";

/// The pairs of one table: structures down, settings across.
class Grid {
public:
    explicit Grid(const std::vector<Pair>& pairs) {
        for (const Pair& pair : pairs) {
            const Case& c = pair.ours->setting;
            const auto row = position(structures_, {c.structure, c.split});
            const auto column = position(settings_, {c.sources.rho, c.tau});
            cells_[{row, column}] = pair;
        }
    }

    /// A table with a column for each setting; `cell(pair, column)` is asked where there is a pair.
    template <class Cell>
    TextTable table(std::string_view title, std::string_view note, Cell&& cell) const {
        TextTable table{std::string(title),
                        std::string(note),
                        {{"structure", Align::left}, {"split", Align::left}},
                        {}};
        for (const auto& [rho, tau] : settings_) {
            table.columns.push_back({fmt::format("ρ {} τ {}", rho, tau)});
        }
        for (std::size_t i = 0; i < structures_.size(); ++i) {
            const auto& [structure, split] = structures_[i];
            auto& row = table.rows.emplace_back();
            row = {structure, std::string(split ? name_of(*split) : "")};
            for (std::size_t j = 0; j < settings_.size(); ++j) {
                const auto found = cells_.find({i, j});
                row.push_back(found == cells_.end() ? std::string(absent) : cell(found->second, j));
            }
        }
        return table;
    }

    /// Place of `value` among column `j`, from 1 for the smallest.
    template <class Value>
    std::size_t rank(double value, std::size_t j, Value&& value_of) const {
        std::size_t smaller = 0;
        for (const auto& [key, pair] : cells_) {
            if (key.second == j && pair.ours->measures && value_of(pair) < value) ++smaller;
        }
        return smaller + 1;
    }

private:
    template <class T>
    static std::size_t position(std::vector<T>& list, const T& value) {
        const auto found = std::find(list.begin(), list.end(), value);
        const auto index = static_cast<std::size_t>(found - list.begin());
        if (found == list.end()) list.push_back(value);
        return index;
    }

    std::vector<std::pair<std::string, std::optional<SplitRule>>> structures_;
    std::vector<std::pair<double, double>> settings_;
    std::map<std::pair<std::size_t, std::size_t>, Pair> cells_;
};

TextTable comparison_table(const Grid& grid, const Comparison& comparison) {
    const auto ours = [&](const Pair& p) {
        return comparison.unit * value(comparison.table, *p.ours->measures);
    };
    const auto paper = [&](const Pair& p) { return value(comparison.table, *p.paper); };
    return grid.table(comparison.title, comparison.note, [&](const Pair& p, std::size_t column) {
        if (!p.ours->measures) return fmt::format("failed / {}", paper(p));
        if (!comparison.ranks) return fmt::format("{:.2f} / {}", ours(p), paper(p));
        return fmt::format("{:.3g} ({}) / {} ({})", ours(p), grid.rank(ours(p), column, ours),
                           paper(p), grid.rank(paper(p), column, paper));
    });
}

TextTable memory_table(const Grid& grid) {
    return grid.table("Memory really taken [MB]",
                      "The structures of Table 1: metrics, topology and auxiliary data.",
                      [](const Pair& p, std::size_t) {
                          if (!p.ours->measures) return std::string("failed");
                          const auto bytes = p.ours->measures->footprint.bytes_total();
                          return fmt::format("{:.2f}", static_cast<double>(bytes) / mb);
                      });
}

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

std::vector<TextTable> paper_comparison(const Study& study, std::span<const Row> rows) {
    const Box unit{Point::Constant(-1), Point::Constant(1)};
    std::vector<Pair> pairs;
    for (const Row& row : rows) {
        if (!is_as_published(row.setting) || study.domain.value_or(unit) != unit) continue;
        if (const PaperRow* paper = paper_row(row.setting)) pairs.push_back({&row, paper});
    }
    std::vector<TextTable> tables;
    if (pairs.empty()) return tables;
    const Grid grid(pairs);
    for (const Comparison& comparison : comparisons) {
        tables.push_back(comparison_table(grid, comparison));
    }
    tables.insert(tables.begin() + 1, memory_table(grid));
    return tables;
}

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

std::string render_tables(const Study& study, std::span<const Row> rows, TableStyle style) {
    std::string text;
    const auto add = [&](const std::vector<TextTable>& tables) {
        for (const TextTable& table : tables) {
            if (!text.empty()) text += '\n';
            text += render(table, style);
        }
    };
    add(paper_comparison(study, rows));
    add(measure_tables(rows));
    add(pareto_tables(rows));
    return text;
}

}  // namespace controlspace
