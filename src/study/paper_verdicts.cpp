#include "study/paper_verdicts.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

namespace controlspace {
namespace {

/// In units of the last printed digit.
long long rounded(double x) { return std::llround(x * 100); }

/// Whether `x` is from `low` to `high`, all as printed.
bool prints_within(double x, double low, double high) {
    return rounded(low) <= rounded(x) && rounded(x) <= rounded(high);
}

/// What one experiment says of a cell.
struct Explanation {
    bool holds;
    std::string text;
};

/// A cell on trial.
struct Question {
    const PaperEvidence& evidence;
    PaperTable table;
    const Case& setting;
    const Measures& ours;
    const PaperRow& paper;

    double our_value() const { return value(table, ours); }
    double paper_value() const { return value(table, paper); }
    double difference() const { return std::abs(our_value() - paper_value()); }
};

using Rule = std::optional<Explanation> (*)(const Question&);

std::optional<Explanation> balance(const Question& q) {
    const Case plain = with_structure(q.setting, "K_oL");
    const Measures* ours = q.evidence.find(plain);
    const PaperRow* paper = paper_row(plain);
    if (q.setting.structure != "K_oLB" || ours == nullptr || paper == nullptr) return std::nullopt;
    const double our_growth = value(PaperTable::size, q.ours) / value(PaperTable::size, *ours);
    const double paper_growth = q.paper.size_mb / paper->size_mb;
    const double our_delta = q.ours.accuracy.max;
    const bool accurate = q.table != PaperTable::delta_r || our_delta <= ours->accuracy.max;
    return Explanation{
        our_growth < 2 && paper_growth > 3 && accurate,
        fmt::format("balance: balanced 2:1, ours has {:.2f} times K_oL's size and delta_R "
                    "{:.2f} against its {:.2f}; the paper's has {:.1f} times",
                    our_growth, our_delta, ours->accuracy.max, paper_growth)};
}

/// Least and largest value of ours and of `variants`.
std::pair<double, double> range(const Question& q, const std::vector<const Measures*>& variants) {
    std::pair<double, double> range{q.our_value(), q.our_value()};
    for (const Measures* m : variants) {
        range.first = std::min(range.first, value(q.table, *m));
        range.second = std::max(range.second, value(q.table, *m));
    }
    return range;
}

std::optional<Explanation> ties(const Question& q) {
    if (!q.setting.split || *q.setting.split == SplitRule::middle) return std::nullopt;
    const auto variants = q.evidence.near_ties(q.setting);
    if (variants.empty()) return Explanation{false, "ties: not tried here"};
    const auto [low, high] = range(q, variants);
    return Explanation{q.difference() <= high - low || prints_within(q.paper_value(), low, high),
                       fmt::format("ties: {} runs that choose otherwise among edges of almost "
                                   "equal length give {:.2f} to {:.2f}",
                                   variants.size(), low, high)};
}

std::optional<Explanation> shared_vertices(const Question& q) {
    if (q.setting.structure != "K_V" && q.setting.structure != "K_oV") return std::nullopt;
    const double nodes = nodes_in_published_size(q.ours, q.paper);
    const auto places = static_cast<double>(q.ours.footprint.control_nodes);
    const bool better = q.table != PaperTable::delta_r || q.our_value() < q.paper_value();
    return Explanation{
        nodes > 1.05 * places && better,
        fmt::format("shared vertices: the paper's size holds {:.0f} control nodes, ours one for "
                    "each of {:.0f} places",
                    nodes, places)};
}

std::optional<Explanation> links(const Question& q) {
    if (q.setting.structure != "K_oL" || q.table != PaperTable::delta_r) return std::nullopt;
    Case queue = q.setting;
    queue.schedule = GradationSchedule::queue;
    const Measures* all_faces = q.evidence.find(queue);
    if (all_faces == nullptr) return Explanation{false, "links: not tried here"};
    return Explanation{
        q.difference() <= std::abs(all_faces->accuracy.max - q.our_value()),
        fmt::format("links: which leaves are compared decides; with one leaf a face and passes "
                    "{:.2f}, with all leaves and the queue {:.2f}",
                    q.our_value(), all_faces->accuracy.max)};
}

std::optional<Explanation> scatter(const Question& q) {
    if (q.table != PaperTable::delta_r) return std::nullopt;
    const auto variants = q.evidence.near_densities(q.setting);
    if (variants.empty()) return std::nullopt;
    const auto [low, high] = range(q, variants);
    return Explanation{prints_within(q.paper_value(), low, high),
                       fmt::format("scatter: the largest of 27000 errors is {:.2f} to {:.2f} with "
                                   "sources 1 % closer or farther apart",
                                   low, high)};
}

constexpr Rule rules[] = {balance, ties, shared_vertices, links, scatter};

CellVerdict judged(const PaperEvidence& evidence, PaperTable table,
                   const PaperEvidence::Cell& cell) {
    const Row& row = *cell.ours;
    if (!row.measures) return {cell, Verdict::failed, row.error};
    if (table == PaperTable::creation) return {cell, Verdict::not_comparable, "another machine"};
    if (table == PaperTable::access) return {cell, Verdict::not_comparable, "ticks of 0.370 µs"};
    const Question q{evidence, table, row.setting, *row.measures, *cell.paper};
    if (equals_printed(q.our_value(), q.paper_value())) return {cell, Verdict::equal, ""};
    std::vector<std::string> tried;
    for (const Rule rule : rules) {
        const auto explanation = rule(q);
        if (!explanation) continue;
        if (explanation->holds) return {cell, Verdict::explained, explanation->text};
        tried.push_back(explanation->text);
    }
    const std::string text = tried.empty() ? "no experiment bears on it"
                                           : fmt::format("not {}", fmt::join(tried, "; not "));
    return {cell, Verdict::unexplained, text};
}

}  // namespace

std::string_view to_string(Verdict verdict) {
    switch (verdict) {
        case Verdict::equal:
            return "equal";
        case Verdict::explained:
            return "explained";
        case Verdict::not_comparable:
            return "not comparable";
        case Verdict::unexplained:
            return "differs, unexplained";
        case Verdict::failed:
            break;
    }
    return "failed";
}

bool equals_printed(double ours, double paper) { return rounded(ours) == rounded(paper); }

bool is_touched_by_fault(std::string_view structure) {
    return structure == "K_oLB" || structure == "K_V" || structure == "K_oV";
}

double nodes_in_published_size(const Measures& ours, const PaperRow& paper) {
    constexpr double bytes_of_node = 104;
    const double more_bytes =
        paper.size_mb * 1e6 - static_cast<double>(ours.footprint.bytes_published.value_or(0));
    return static_cast<double>(ours.footprint.control_nodes) + more_bytes / bytes_of_node;
}

Case with_structure(Case setting, std::string_view id) {
    setting.structure = id;
    return setting;
}

std::vector<CellVerdict> judge(const PaperEvidence& evidence, PaperTable table) {
    std::vector<CellVerdict> verdicts;
    for (const PaperEvidence::Cell& cell : evidence.cells()) {
        verdicts.push_back(judged(evidence, table, cell));
    }
    return verdicts;
}

}  // namespace controlspace
