#include "study/paper_experiments.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "study/names.h"
#include "study/paper_verdicts.h"
#include "study/rank_correlation.h"

namespace controlspace {
namespace {

using Cell = PaperEvidence::Cell;
using Cells = std::vector<std::string>;

/// Columns that name a case.
const std::vector<TextTable::Column> case_columns{
    {"structure", Align::left}, {"split", Align::left}, {"ρ"}, {"τ"}};

TextTable empty_table(std::string title, std::string note, std::vector<std::string> headers) {
    TextTable table{std::move(title), std::move(note), case_columns, {}};
    for (std::string& header : headers) table.columns.push_back({std::move(header)});
    return table;
}

std::string fixed(double x) { return fmt::format("{:.2f}", x); }
double megabytes(std::size_t bytes) { return static_cast<double>(bytes) / 1e6; }

/// "5.15 to 5.72" over `ours` and its variants.
std::string range_text(PaperTable table, const Measures& ours,
                       const std::vector<const Measures*>& variants) {
    double low = value(table, ours);
    double high = low;
    for (const Measures* m : variants) {
        low = std::min(low, value(table, *m));
        high = std::max(high, value(table, *m));
    }
    return fmt::format("{:.2f} to {:.2f}", low, high);
}

/// Adds a line for each cell for which `more` gives further columns.
template <class More>
void fill(TextTable& table, const PaperEvidence& evidence, More&& more) {
    for (const Cell& cell : evidence.cells()) {
        if (!cell.ours->measures) continue;
        const Cells columns = more(cell, cell.ours->setting, *cell.ours->measures);
        if (columns.empty()) continue;
        const Case& c = cell.ours->setting;
        auto& row = table.rows.emplace_back(
            Cells{c.structure, std::string(c.split ? name_of(*c.split) : ""),
                  fmt::format("{}", c.sources.rho), fmt::format("{}", c.tau)});
        row.insert(row.end(), columns.begin(), columns.end());
    }
}

TextTable balance(const PaperEvidence& evidence) {
    auto table = empty_table("Experiment: balance",
                             "K_oLB with every leaf at most one level finer than its neighbours "
                             "across faces, beside K_oL at the same setting.",
                             {"MB", "times K_oL", "paper MB", "times K_oL", "delta_R",
                              "K_oL delta_R", "paper delta_R", "paper K_oL delta_R"});
    fill(table, evidence, [&](const Cell& cell, const Case& c, const Measures& m) -> Cells {
        const Case plain = with_structure(c, "K_oL");
        const Measures* ours = evidence.find(plain);
        const PaperRow* paper = paper_row(plain);
        if (c.structure != "K_oLB" || ours == nullptr || paper == nullptr) return {};
        const double size = value(PaperTable::size, m);
        return {fixed(size),
                fixed(size / value(PaperTable::size, *ours)),
                fixed(cell.paper->size_mb),
                fixed(cell.paper->size_mb / paper->size_mb),
                fixed(m.accuracy.max),
                fixed(ours->accuracy.max),
                fixed(cell.paper->delta_r_max),
                fixed(paper->delta_r_max)};
    });
    return table;
}

TextTable shared_vertices(const PaperEvidence& evidence) {
    auto table = empty_table(
        "Experiment: shared vertices",
        "Our trees have one control node at each place. The paper's number follows "
        "from its size, which counts 104 bytes for each, on the elements of our tree. Of several "
        "nodes at one place each gets what its own leaves get.",
        {"places", "paper's nodes", "nodes a place", "delta_R", "paper delta_R"});
    fill(table, evidence, [](const Cell& cell, const Case& c, const Measures& m) -> Cells {
        if (c.structure != "K_V" && c.structure != "K_oV") return {};
        const double nodes = nodes_in_published_size(m, *cell.paper);
        return {fmt::format("{}", m.footprint.control_nodes), fmt::format("{:.0f}", nodes),
                fixed(nodes / static_cast<double>(m.footprint.control_nodes)),
                fixed(m.accuracy.max), fixed(cell.paper->delta_r_max)};
    });
    return table;
}

TextTable depth_limit(const PaperEvidence& evidence) {
    auto table = empty_table("Experiment: the depth limit of s_M",
                             "s_M peels slabs, so its depth grows linearly with the box. Levels "
                             "are those of the tree, its root being level 1.",
                             {"limit", "levels", "leaves", "delta_R", "mean", "paper delta_R"});
    for (const Cell& cell : evidence.cells()) {
        auto rows = evidence.other_depths(cell.ours->setting);
        if (rows.empty() || !cell.ours->measures) continue;
        rows.insert(rows.begin(), cell.ours);
        for (const Row* row : rows) {
            const Case& c = row->setting;
            const Measures& m = *row->measures;
            table.rows.push_back(
                {c.structure, std::string(name_of(*c.split)), fmt::format("{}", c.sources.rho),
                 fmt::format("{}", c.tau), fmt::format("{}", *c.max_depth),
                 fmt::format("{}", m.footprint.depth), fmt::format("{}", m.footprint.leaves),
                 fixed(m.accuracy.max), fmt::format("{:.4f}", m.accuracy.mean),
                 row == cell.ours ? fixed(cell.paper->delta_r_max) : "–"});
        }
    }
    return table;
}

TextTable near_ties(const PaperEvidence& evidence) {
    auto table = empty_table("Experiment: edges that are almost equally long",
                             "s_G and s_M cut boxes whose edges are equally long but for rounding "
                             "or the digits of the golden section, and s_M slabs that are as long "
                             "as l_min but for rounding. Range over runs with another order among "
                             "them: a box longer by a billionth along some axes, l_min by as much, "
                             "s_G's sections to all digits instead of five.",
                             {"runs", "MB", "range", "paper", "delta_R", "range", "paper"});
    fill(table, evidence, [&](const Cell& cell, const Case& c, const Measures& m) -> Cells {
        const auto variants = evidence.near_ties(c);
        if (variants.empty()) return {};
        return {fmt::format("{}", variants.size()),
                fixed(value(PaperTable::size, m)),
                range_text(PaperTable::size, m, variants),
                fixed(cell.paper->size_mb),
                fixed(m.accuracy.max),
                range_text(PaperTable::delta_r, m, variants),
                fixed(cell.paper->delta_r_max)};
    });
    return table;
}

TextTable accounting(const PaperEvidence& evidence) {
    auto table =
        empty_table("Experiment: the accounting of Table 1",
                    "The paper's size counts 136 bytes a leaf, 108 (kd-tree) or 216 (octree) an "
                    "inner node and 104 a vertex, and no metric of a leaf. Beside it what our "
                    "structure allocates, the metrics in it among that.",
                    {"paper MB", "in its accounting", "allocated", "metrics", "paper / allocated"});
    fill(table, evidence, [](const Cell& cell, const Case&, const Measures& m) -> Cells {
        const double allocated = megabytes(m.footprint.bytes_total());
        return {fixed(cell.paper->size_mb), fixed(value(PaperTable::size, m)), fixed(allocated),
                fixed(megabytes(m.footprint.bytes_payload)),
                fixed(cell.paper->size_mb / allocated)};
    });
    return table;
}

TextTable clock_ticks() {
    constexpr double tick = 1e4 / 27000;   // µs a query: a clock of 10 ms over 27000 queries
    constexpr double half_digit = 0.0051;  // of the printed value, and its own rounding
    std::size_t whole = 0;
    double farthest = 0;
    double shortest = paper_rows().front().access_us;
    std::set<long> different;
    for (const PaperRow& row : paper_rows()) {
        const double ticks = std::round(row.access_us / tick);
        const double off = std::abs(row.access_us - ticks * tick);
        if (off <= half_digit) ++whole;
        farthest = std::max(farthest, off);
        shortest = std::min(shortest, row.access_us);
        different.insert(std::lround(ticks));
    }
    return {"Experiment: the clock of Table 3",
            "Checked on the paper's own table: a clock of 10 ms over 27000 queries gives 0.370 µs.",
            {{"entries"},
             {"whole ticks"},
             {"farthest from one [µs]"},
             {"different values"},
             {"shortest [ticks]"}},
            {{fmt::format("{}", paper_rows().size()), fmt::format("{}", whole),
              fmt::format("{:.4f}", farthest), fmt::format("{}", different.size()),
              fmt::format("{:.0f}", shortest / tick)}}};
}

TextTable two_references(const PaperEvidence& evidence) {
    auto table =
        empty_table("Experiment: the two references",
                    "The same graded structure against the analytic field h + s ||p| - r| with s "
                    "= 2 (g-1)/(g+1), and against the exact field of all sources' cones.",
                    {"analytic", "exact", "paper", "analytic, mean", "exact, mean"});
    fill(table, evidence, [&](const Cell& cell, const Case& c, const Measures& m) -> Cells {
        Case exact = c;
        exact.reference = ReferenceKind::exact;
        const Measures* other = evidence.find(exact);
        if (other == nullptr) return {};
        return {fixed(m.accuracy.max), fixed(other->accuracy.max), fixed(cell.paper->delta_r_max),
                fmt::format("{:.4f}", m.accuracy.mean),
                fmt::format("{:.4f}", other->accuracy.mean)};
    });
    return table;
}

TextTable schedules(const PaperEvidence& evidence) {
    auto table = empty_table(
        "Experiment: links and schedules",
        "At most ten passes over the nearest leaf across each face, as for the tables, and "
        "the queue of the paper's text over all leaves across each face, until nothing "
        "changes. G left: the largest gradation ratio between linked nodes at the end.",
        {"delta_R passes", "queue", "paper", "G left passes", "queue"});
    fill(table, evidence, [&](const Cell& cell, const Case& c, const Measures& m) -> Cells {
        Case queue = c;
        queue.schedule = GradationSchedule::queue;
        const Measures* other = evidence.find(queue);
        if (other == nullptr) return {};
        return {fixed(m.accuracy.max), fixed(other->accuracy.max), fixed(cell.paper->delta_r_max),
                fmt::format("{:.4f}", m.gradation.largest_ratio_left),
                fmt::format("{:.4f}", other->gradation.largest_ratio_left)};
    });
    return table;
}

TextTable scatter(const PaperEvidence& evidence) {
    auto table = empty_table("Experiment: what a maximum over 27000 places is worth",
                             "Largest delta_R with the sources a little closer together or farther "
                             "apart: differences within the range say nothing of a structure.",
                             {"runs", "delta_R", "range", "paper"});
    fill(table, evidence, [&](const Cell& cell, const Case& c, const Measures& m) -> Cells {
        const auto variants = evidence.near_densities(c);
        if (variants.empty()) return {};
        return {fmt::format("{}", variants.size()), fixed(m.accuracy.max),
                range_text(PaperTable::delta_r, m, variants), fixed(cell.paper->delta_r_max)};
    });
    return table;
}

/// Spearman's rho over the cells of one setting.
template <class Ours, class Paper>
std::optional<double> rank_correlation(const std::vector<Cell>& cells, bool with_faults,
                                       Ours&& ours, Paper&& paper) {
    std::vector<double> a, b;
    for (const Cell& cell : cells) {
        if (!with_faults && is_touched_by_fault(cell.paper->structure)) continue;
        a.push_back(ours(*cell.ours->measures));
        b.push_back(paper(*cell.paper));
    }
    return spearman(a, b);
}

}  // namespace

std::vector<TextTable> paper_experiments(const PaperEvidence& evidence) {
    std::vector<TextTable> tables{
        balance(evidence),        shared_vertices(evidence), depth_limit(evidence),
        near_ties(evidence),      accounting(evidence),      clock_ticks(),
        two_references(evidence), schedules(evidence),       scatter(evidence)};
    for (TextTable& table : tables) {
        if (table.rows.empty())
            table.note += " Not in these results: see `controlspace paper --experiments`.";
    }
    return tables;
}

TextTable rank_table(const PaperEvidence& evidence) {
    std::vector<std::pair<double, double>> settings;
    std::vector<std::vector<Cell>> cells;
    for (const Cell& cell : evidence.cells()) {
        if (!cell.ours->measures) continue;
        const std::pair setting{cell.paper->rho, cell.paper->tau};
        auto at = std::find(settings.begin(), settings.end(), setting);
        if (at == settings.end()) {
            at = settings.insert(at, setting);
            cells.emplace_back();
        }
        cells[static_cast<std::size_t>(at - settings.begin())].push_back(cell);
    }
    TextTable table{"Ranks: Spearman's rho, ours against the paper's",
                    "Within each column of a table. 1: the same order; -1: the reverse; ties share "
                    "the mean of their ranks. Without faults: without K_oLB, K_V and K_oV.",
                    {{"table", Align::left}, {"rows", Align::left}, {"mean"}},
                    {}};
    for (const auto& [rho, tau] : settings) {
        table.columns.push_back({fmt::format("ρ {} τ {}", rho, tau)});
    }
    const auto add = [&](const std::string& name, auto&& ours, auto&& paper) {
        for (const bool with_faults : {true, false}) {
            auto& row =
                table.rows.emplace_back(Cells{name, with_faults ? "all" : "without faults"});
            double sum = 0;
            std::size_t known = 0;
            for (const auto& column : cells) {
                const auto correlation = rank_correlation(column, with_faults, ours, paper);
                row.push_back(correlation ? fixed(*correlation) : "–");
                sum += correlation.value_or(0);
                known += correlation ? 1 : 0;
            }
            row.insert(row.begin() + 2, known > 0 ? fixed(sum / static_cast<double>(known)) : "–");
        }
    };
    for (const PaperTable t : paper_tables) {
        add(
            std::string(title(t)), [t](const Measures& m) { return value(t, m); },
            [t](const PaperRow& p) { return value(t, p); });
    }
    add(
        "Table 1 against the memory really allocated",
        [](const Measures& m) { return megabytes(m.footprint.bytes_total()); },
        [](const PaperRow& p) { return p.size_mb; });
    return table;
}

}  // namespace controlspace
