#include "study/paper_evidence.h"

#include <algorithm>
#include <cmath>

namespace controlspace {
namespace {

constexpr double rounding = 1e-8;  // relative; what the experiments change is a tenth of it

bool near(double a, double b, double relative) { return std::abs(a - b) <= relative * std::abs(b); }

const Box& paper_box() {
    static const Box box{Point::Constant(-1), Point::Constant(1)};
    return box;
}

bool is_near_paper_box(const Box& box) {
    return (box.low - paper_box().low).cwiseAbs().maxCoeff() <= rounding &&
           (box.high - paper_box().high).cwiseAbs().maxCoeff() <= rounding;
}

}  // namespace

std::string_view title(PaperTable table) {
    switch (table) {
        case PaperTable::size:
            return "Table 1: size in the paper's accounting [MB]";
        case PaperTable::creation:
            return "Table 2: creation time [s]";
        case PaperTable::access:
            return "Table 3: access time [µs]";
        case PaperTable::delta_r:
            break;
    }
    return "Table 4: largest delta_R";
}

double value(PaperTable table, const Measures& m) {
    switch (table) {
        case PaperTable::size:
            return static_cast<double>(m.footprint.bytes_published.value_or(0)) / 1e6;
        case PaperTable::creation:
            return m.insert_s + m.gradation_s;
        case PaperTable::access:
            return m.access_random.median_ns() / 1e3;
        case PaperTable::delta_r:
            break;
    }
    return m.accuracy.max;
}

double value(PaperTable table, const PaperRow& p) {
    switch (table) {
        case PaperTable::size:
            return p.size_mb;
        case PaperTable::creation:
            return p.creation_s;
        case PaperTable::access:
            return p.access_us;
        case PaperTable::delta_r:
            break;
    }
    return p.delta_r_max;
}

void PaperEvidence::add(const Study& study, std::span<const Row> rows) {
    const Box box = study.domain.value_or(paper_box());
    if (!is_near_paper_box(box)) return;
    for (const Row& row : rows) {
        const bool known = std::any_of(entries_.begin(), entries_.end(), [&](const Entry& entry) {
            return entry.box == box && entry.row.setting == row.setting;
        });
        if (!known) entries_.push_back({row, box});
    }
}

std::vector<PaperEvidence::Cell> PaperEvidence::cells() const {
    std::vector<Cell> cells;
    for (const Entry& entry : entries_) {
        if (entry.box != paper_box() || !is_as_published(entry.row.setting)) continue;
        if (const PaperRow* paper = paper_row(entry.row.setting)) {
            cells.push_back({&entry.row, paper});
        }
    }
    // The paper's rows lie in one array.
    std::sort(cells.begin(), cells.end(),
              [](const Cell& a, const Cell& b) { return a.paper < b.paper; });
    return cells;
}

const Measures* PaperEvidence::find(const Case& setting) const {
    for (const Entry& entry : entries_) {
        if (entry.box == paper_box() && entry.row.measures && entry.row.setting == setting) {
            return &*entry.row.measures;
        }
    }
    return nullptr;
}

std::vector<const Measures*> PaperEvidence::near_ties(const Case& setting) const {
    std::vector<const Measures*> found;
    for (const auto& [row, box] : entries_) {
        if (!row.measures || !near(row.setting.tau, setting.tau, rounding)) continue;
        if (box == paper_box() && row.setting == setting) continue;
        Case same = row.setting;
        same.tau = setting.tau;
        if (same.split == SplitRule::exact_golden) same.split = SplitRule::golden;
        if (same == setting) found.push_back(&*row.measures);
    }
    return found;
}

std::vector<const Measures*> PaperEvidence::near_densities(const Case& setting) const {
    std::vector<const Measures*> found;
    for (const auto& [row, box] : entries_) {
        const double rho = row.setting.sources.rho;
        if (box != paper_box() || !row.measures || rho == setting.sources.rho ||
            !near(rho, setting.sources.rho, 0.05)) {
            continue;
        }
        Case same = row.setting;
        same.sources.rho = setting.sources.rho;
        if (same == setting) found.push_back(&*row.measures);
    }
    return found;
}

std::vector<const Row*> PaperEvidence::other_depths(const Case& setting) const {
    std::vector<const Row*> found;
    for (const auto& [row, box] : entries_) {
        Case same = row.setting;
        same.max_depth = setting.max_depth;
        if (box == paper_box() && row.measures && same == setting && row.setting != setting) {
            found.push_back(&row);
        }
    }
    std::sort(found.begin(), found.end(), [](const Row* a, const Row* b) {
        return a->setting.max_depth < b->setting.max_depth;
    });
    return found;
}

}  // namespace controlspace
