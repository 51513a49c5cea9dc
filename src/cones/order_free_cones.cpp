// SPDX-License-Identifier: Apache-2.0
#include "cones/order_free_cones.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "cones/exceeded_cones.h"
#include "cones/undominated.h"
#include "controlspace/input_errors.h"
#include "controlspace/sources/cone.h"
#include "geometry/extent_of.h"
#include "geometry/hash_of_words.h"
#include "metric/decompose.h"
#include "metric/interior_point.h"

namespace controlspace {

// What an answer proves
// ---------------------
// Let H be the factor of an answer of the core set, whose duality gap is e, and
// let all cones be exceeded by factors of at most s in squared lengths, s >= 1.
// Then H H^T / s is within all cones, and its log det is below that of the best
// by e + 3 ln s at most, since the best of all cones is no larger than the best
// of the core set. Together they are 6 ln(1 + t), so that log det M, half of
// it, is within 3 ln(1 + t).
//
// Why the search ends: a core set keeps its optimum when it is reduced to the
// six cones that a certificate needs (Caratheodory), and the optimum decreases
// with each exceeded cone that joins.
//
// Cells are dyadic: those of a level have half the edge of the level before.
// The answer at the centre of a cell starts from that of the cell which
// contains it, so all depend on places alone. A cell is small enough if no
// cone's factor varies much in it: by the law of gradation, by the length of
// half its diagonal in the metric at its centre, times g - 1. Larger cells lead
// to smaller ones only, and are answered loosely, by cones near those of the
// cell before but for the largest cells.

namespace {

constexpr std::int64_t most_cells_from_origin = 4'000'000'000'000'000'000;

bool is_beyond_cells(std::int64_t key) { return std::abs(key) == most_cells_from_origin; }

constexpr double tolerance_of_start = 0.3;  // of cells that lead to smaller ones

// Throws what `failure(text)` is for what `order_free_intersection` does not accept.
template <class Failure>
void require_valid(const Metric& metric, const Failure& failure) {
    try {
        order_free_intersection({&metric, 1});
    } catch (const InputError& error) {
        throw failure(error.what());
    }
}

auto failure_of(const char* name) {
    return [name](const char* what) { return InputError(fmt::format("{}: {}", name, what)); };
}

}  // namespace

// Cones that are intersected, the largest metric first.
class OrderFreeCones::Core {
public:
    void add(std::uint32_t member, const Metric& cone) {
        members_[size_] = member;
        cones_[size_++] = cone;
    }
    bool has(std::uint32_t member) const {
        const auto end = members_.begin() + static_cast<std::ptrdiff_t>(size_);
        return std::find(members_.begin(), end, member) != end;
    }
    std::size_t size() const { return size_; }
    bool has_room_for(std::size_t more) const { return size_ + more <= members_.size(); }
    std::uint32_t member(std::size_t k) const { return members_[k]; }
    std::span<const Metric> cones() const { return {cones_.data(), size_}; }

    OrderFreeIntersection intersection(double gap, const Eigen::Matrix3d* near) const {
        if (near == nullptr || size_ < 3) return order_free_intersection(cones(), gap);
        InteriorPoint solution(cones(), near);
        solution.solve(gap);
        if (!(std::abs(solution.gap()) <= gap)) return order_free_intersection(cones(), gap);
        OrderFreeIntersection answer{
            .factor = solution.factor(), .gap = solution.gap(), .steps = solution.steps()};
        answer.count = size_;
        for (std::size_t k = 0; k < size_; ++k) {
            answer.multiplier[k] = {static_cast<std::uint32_t>(k), solution.multiplier(k)};
        }
        return answer;
    }
    /// Leaves the first `fixed`, and those that the certificate of an answer
    /// needs.
    void reduce(const OrderFreeIntersection& answer, std::size_t fixed) {
        std::array<Metric, OrderFreeIntersection::most_multipliers> tensors;
        const auto multipliers = answer.multipliers();
        std::transform(multipliers.begin(), multipliers.end(), tensors.begin(),
                       [](const auto& multiplier) { return multiplier.tensor; });
        const std::uint32_t needed = needed_multipliers({tensors.data(), answer.count});
        std::uint32_t kept = (1u << fixed) - 1;
        for (std::size_t k = 0; k < answer.count; ++k) {
            if ((needed >> k & 1) != 0) kept |= 1u << multipliers[k].index;
        }
        std::size_t size = 0;
        for (std::size_t k = 0; k < size_; ++k) {
            if ((kept >> k & 1) == 0) continue;
            members_[size] = members_[k];
            cones_[size++] = cones_[k];
        }
        size_ = size;
    }

private:
    std::size_t size_ = 0;
    std::array<std::uint32_t, OrderFreeIntersection::most_multipliers> members_;
    std::array<Metric, OrderFreeIntersection::most_multipliers> cones_;
};

OrderFreeCones::OrderFreeCones(std::span<const PointSource> sources, double g,
                               const Metric& largest, double tolerance)
    : steepest_(largest_growth(sources, g) - 1), largest_(largest), tolerance_(tolerance) {
    require_valid(largest, failure_of("the largest metric"));
    for (std::size_t i = 0; i < sources.size(); ++i) {
        require_valid(sources[i].metric, [&](const char* what) {
            return IndexedError(i, fmt::format("source {}: {}", i, what));
        });
    }
    const auto lengths_of_largest = eigen_frame(largest).lengths;
    UndominatedSources kept = undominated_sources(sources, g, lengths_of_largest[2]);
    dropped_ = kept.dropped;
    if (kept.items.empty()) return;
    const Box extent = extent_of(kept.items, &ConeTreeItem::position);
    kept.tree = {};
    rounding_ = std::max(0.1 * kept.uncertainty, 1e-13);
    tree_ = QuadricTree(std::move(kept.items), sources, kept.uncertainty, g);
    origin_ = extent.low;
    edge_ = std::max(extent.edges().maxCoeff(), lengths_of_largest[0]);
    answer(extent.centre(), nullptr, {}, tolerance_of_start, &start_);
}

double OrderFreeCones::gap_of(double tolerance) {
    constexpr double least_tolerance = 1e-7;
    return 6 * std::log1p(std::max(tolerance, least_tolerance));
}

void OrderFreeCones::append_sources(const Start& start, std::vector<std::uint32_t>& sources) const {
    for (std::uint32_t k = 0; k < start.count; ++k) {
        sources.push_back(tree_.indices()[start.members[k]]);
    }
}

double OrderFreeCones::growth(const Point& p, const Eigen::Matrix3d& h,
                              const PointSource& source) const {
    const Eigen::Matrix3d k = Cholesky(source.metric).solve(h) / cone_factor(source, 1, p);
    return eigen_frame(Metric::from_matrix(k.transpose() * k)).lengths[2];
}

OrderFreeIntersection OrderFreeCones::answer(const Point& p, const Metric* further,
                                             const Start& start, double tolerance, Start* found,
                                             std::optional<int> levels) const {
    const double allowed_gap = gap_of(tolerance);
    const double allowed = std::exp(0.9 * allowed_gap / 3);
    const double gap = 0.1 * allowed_gap;
    Core core;
    core.add(index_of_largest, largest_);
    if (further != nullptr) core.add(index_of_further, *further);
    const std::size_t fixed = core.size();
    const auto add = [&](std::uint32_t number) {
        const PointSource source = tree_.source(number);
        core.add(number, cone_factor(source, 1, p) * source.metric);
    };
    for (std::uint32_t k = 0; k < start.count; ++k) add(start.members[k]);
    Eigen::Matrix3d last = start.factor;
    bool is_near = start.count > 0;
    constexpr int most_rounds = 200;  // against rounding
    for (int round = 0;; ++round) {
        OrderFreeIntersection answer = core.intersection(gap, is_near ? &last : nullptr);
        // Of one metric or two, exactly: so it stays if it exceeds no cone.
        bool is_exact = answer.gap == 0;
        double limit = is_exact ? 1 + rounding_ : allowed;
        if (!tree_.empty()) {
            Exceeded exceeded(limit);
            const Exceeding exceeding(p, answer.factor);
            // What exceeds H most at a place is often near to what did so elsewhere: nodes that are
            // not far above the members.
            std::array<std::uint32_t, OrderFreeIntersection::most_multipliers> all_nearby;
            std::span<const std::uint32_t> nearby;
            for (std::size_t k = fixed; k < core.size(); ++k) {
                std::uint32_t node = tree_.leaf_of(core.member(k));
                for (int up = levels.value_or(2); up > 0; --up) node = tree_.parent(node);
                if (std::ranges::find(nearby, node) != nearby.end()) continue;
                all_nearby[nearby.size()] = node;
                nearby = {all_nearby.data(), nearby.size() + 1};
            }
            for (const std::uint32_t node : nearby) {
                find_exceeded(tree_, node, {}, exceeding, exceeded);
            }
            const auto is_new = [&](const Exceeded::Cone& cone) { return !core.has(cone.member); };
            if (std::ranges::none_of(exceeded.cones(), is_new) && !levels) {
                find_exceeded(tree_, 0, nearby, exceeding, exceeded);
            }
            if (std::ranges::any_of(exceeded.cones(), is_new) && round < most_rounds) {
                if (!core.has_room_for(exceeded.cones().size())) core.reduce(answer, fixed);
                for (const Exceeded::Cone& cone : exceeded.cones()) {
                    if (is_new(cone)) add(cone.member);
                }
                constexpr double far = 4;
                is_near = exceeded.worst() < far;
                last = answer.factor;
                continue;
            }
            is_exact = is_exact && exceeded.empty();
            // Exceeded cones of the core set itself: that is rounding. H is made smaller until it
            // exceeds none.
            constexpr int most_times = 20;
            for (int time = 1; !exceeded.empty() && !levels; ++time) {
                for (const Exceeded::Cone& cone : exceeded.cones()) {
                    limit = std::max(limit, growth(p, answer.factor, tree_.source(cone.member)));
                }
                limit *= 1 + rounding_;
                if (time == most_times) {
                    limit = std::max(limit, exceeded.worst());
                    break;
                }
                exceeded = Exceeded(limit);
                find_exceeded(tree_, 0, {}, exceeding, exceeded);
            }
        }
        if (found != nullptr) {
            found->factor = answer.factor;
            found->count = 0;
            constexpr double counts = 0.01;  // all traces together are 3
            for (const auto& [index, tensor] : answer.multipliers()) {
                if (index < fixed || !(trace(tensor) > counts)) continue;
                if (found->count < most_members)
                    found->members[found->count++] = core.member(index);
            }
        }
        for (std::size_t k = 0; k < answer.count; ++k) {
            auto& [index, tensor] = answer.multiplier[k];
            const std::uint32_t number = core.member(index);
            index = index < fixed ? number : tree_.indices()[number];
            if (!is_exact) tensor = 1 / limit * tensor;
        }
        if (is_exact) return answer;
        answer.factor /= std::sqrt(limit);
        answer.gap += 3 * std::log(limit);
        return answer;
    }
}

std::array<std::int64_t, 4> OrderFreeCones::cell_at(const Point& p, int level) const {
    constexpr auto most = static_cast<double>(most_cells_from_origin);
    std::array<std::int64_t, 4> key{level, 0, 0, 0};
    const double scale = std::ldexp(1 / edge_, level);
    for (int a = 0; a < 3; ++a) {
        const double place = std::floor((p[a] - origin_[a]) * scale);
        key[static_cast<std::size_t>(a) + 1] =
            static_cast<std::int64_t>(place > -most ? std::min(place, most) : -most);
    }
    return key;
}

OrderFreeCones::Cell OrderFreeCones::made_cell(const std::array<std::int64_t, 4>& key,
                                               const Start& from) const {
    constexpr double most_variation = 0.8;
    constexpr int first_rough_level = 2;
    constexpr int most_level = 40;
    const double edge = std::ldexp(edge_, -static_cast<int>(key[0]));
    const Vector place(static_cast<double>(key[1]), static_cast<double>(key[2]),
                       static_cast<double>(key[3]));
    const Point centre = origin_ + edge * (place + Vector::Constant(0.5));
    Cell cell;
    cell.key = key;
    answer(centre, nullptr, from, std::max(tolerance_, tolerance_of_start), &cell.start,
           key[0] >= first_rough_level ? std::optional(2) : std::nullopt);
    const Eigen::Matrix3d& h = cell.start.factor;
    const double shortest =
        std::sqrt(eigen_frame(Metric::from_matrix(h * h.transpose())).lengths[0]);
    const double half_diagonal = 0.5 * std::sqrt(3.0) * edge;
    cell.is_small =
        !(steepest_ * half_diagonal > most_variation * shortest) || key[0] >= most_level;
    if (cell.is_small) answer(centre, nullptr, Start(cell.start), tolerance_, &cell.start);
    return cell;
}

const OrderFreeCones::Start& OrderFreeCones::start_near(const Point& p, Search& search) const {
    constexpr std::size_t least_cells = 64;
    constexpr std::size_t most_cells = 16384;
    if (search.last.is_small &&
        search.last.key == cell_at(p, static_cast<int>(search.last.key[0]))) {
        return search.last.start;
    }
    const auto slot = [](std::vector<Cell>& cells, const auto& key) -> Cell& {
        return cells[hash_of_words(key) & (cells.size() - 1)];
    };
    search.last = {};
    search.last.start = start_;
    for (int level = 0;; ++level) {
        if (2 * search.filled >= search.cells.size() && search.cells.size() < most_cells) {
            std::vector<Cell> more(std::max(least_cells, 4 * search.cells.size()));
            for (const Cell& cell : search.cells) {
                if (cell.key[0] != Cell::none) slot(more, cell.key) = cell;
            }
            search.cells = std::move(more);
        }
        const auto key = cell_at(p, level);
        // So far away, places of one cell may have come from different ones: they start from
        // nothing.
        if (std::ranges::any_of(std::span(key).subspan(1), is_beyond_cells)) {
            search.last = {};
            return search.last.start;
        }
        Cell& cell = slot(search.cells, key);
        if (cell.key != key) {
            search.filled += cell.key[0] == Cell::none ? 1 : 0;
            cell = made_cell(key, search.last.start);
        }
        search.last = cell;
        if (cell.is_small) return search.last.start;
    }
}

OrderFreeIntersection OrderFreeCones::intersect(const Point& p, const Metric* further,
                                                Search& search, const Start* near, Start* found,
                                                std::optional<double> tolerance) const {
    if (further != nullptr) require_valid(*further, failure_of("the further metric"));
    const double t = tolerance.value_or(tolerance_);
    if (tree_.empty() || !p.allFinite()) return answer(p, further, {}, t, found);
    return answer(p, further, near != nullptr ? *near : start_near(p, search), t, found);
}

OrderFreeIntersection OrderFreeCones::intersect_close(const Point& p, const Metric* further,
                                                      const Start& near, Start& found) const {
    if (further != nullptr) require_valid(*further, failure_of("the further metric"));
    return answer(p, further, near, tolerance_, &found, 1);
}

}  // namespace controlspace
