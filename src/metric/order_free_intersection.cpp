// SPDX-License-Identifier: Apache-2.0
#include "controlspace/metric/order_free_intersection.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <tuple>

#include "controlspace/error.h"
#include "metric/decompose.h"
#include "metric/interior_point.h"
#include "metric/reduction.h"

namespace controlspace {

// Six constraints at most are needed for a certificate, so few of many metrics matter. The core
// set has those that may: solve with these alone, add the metric that the answer exceeds most, and
// so on until it exceeds none. All choices go by values, never by places in the list.

namespace {

using Factorisation = CholeskyLanes<constraint_lanes>;

constexpr double largest_anisotropy = 1e7;
constexpr double largest_size = 1e80;  // of lengths: products of six stay in range

auto key(const Metric& m) { return std::tie(m.xx, m.yy, m.zz, m.xy, m.xz, m.yz); }

// Calls visit(first, count, lanes) for all metrics, four at a time; lanes beyond `count` are I.
template <class Visit>
void in_groups(std::span<const Metric> metrics, const Visit& visit) {
    for (std::size_t first = 0; first < metrics.size(); first += constraint_lanes) {
        const std::size_t count = std::min(constraint_lanes, metrics.size() - first);
        ConstraintLanes lanes;
        for (std::size_t i = 0; i < count; ++i) {
            lanes.set(static_cast<Eigen::Index>(i), metrics[first + i]);
        }
        visit(first, count, lanes);
    }
}

[[noreturn]] void refuse(std::size_t index, const Metric& m) {
    if (!is_positive_definite(m)) {
        throw InputError(fmt::format(
            "intersection: metric {}, {}, is not positive definite: give finite, positive lengths",
            index, to_string(m)));
    }
    const double trace = m.xx + m.yy + m.zz;
    if (!(trace > 1 / largest_size && trace < largest_size)) {
        throw InputError(fmt::format(
            "intersection: metric {}, {}, has lengths beyond {} to {}: use another unit of length",
            index, to_string(m), 1 / largest_size, largest_size));
    }
    throw InputError(fmt::format(
        "intersection: metric {}, {}, has an anisotropy above {}: make its largest length smaller",
        index, to_string(m), largest_anisotropy));
}

// Index of the metric of the smallest determinant; all metrics must be valid.
std::size_t smallest_of_valid(std::span<const Metric> metrics) {
    if (metrics.empty()) throw InputError("intersection: no metrics: give at least one");
    std::size_t smallest = 0;
    double least = std::numeric_limits<double>::infinity();
    in_groups(metrics, [&](std::size_t first, std::size_t count, const ConstraintLanes& m) {
        const Factorisation factorisation(m);
        const ConstraintNumbers traces = m.xx + m.yy + m.zz;
        const ConstraintNumbers conditions = traces * factorisation.trace_of_inverse() / 9;
        const ConstraintNumbers pivots = factorisation.least_pivot();
        const ConstraintNumbers determinants = factorisation.determinant();
        for (std::size_t i = 0; i < count; ++i) {
            const auto lane = static_cast<Eigen::Index>(i);
            if (!(pivots[lane] > 0 && conditions[lane] <= largest_anisotropy &&
                  traces[lane] > 1 / largest_size && traces[lane] < largest_size)) {
                refuse(first + i, metrics[first + i]);
            }
            const double here = determinants[lane];
            if (here < least ||
                (here == least && key(metrics[first + i]) < key(metrics[smallest]))) {
                least = here;
                smallest = first + i;
            }
        }
    });
    return smallest;
}

// A metric and by how much H exceeds it: H H^T <= growth M^2.
struct Excess {
    double growth = 0;
    std::size_t index = 0;
};

// The metrics of the greatest growths, `count` of them.
class Farthest {
public:
    Farthest(std::span<const Metric> metrics, std::size_t count)
        : metrics_(metrics), count_(count) {}

    void enter(double growth, std::size_t index) {
        const Excess entered{growth, index};
        if (size_ == count_ && !comes_before(entered, found_[size_ - 1])) return;
        std::size_t place = size_ < count_ ? size_++ : size_ - 1;
        for (; place > 0 && comes_before(entered, found_[place - 1]); --place) {
            found_[place] = found_[place - 1];
        }
        found_[place] = entered;
    }
    // Given an upper bound, but for rounding, of its growth.
    bool might_enter(double bound) const {
        constexpr double rounding = 1e-12;
        return size_ < count_ || (1 + rounding) * bound >= found_[size_ - 1].growth;
    }
    std::span<const Excess> found() const { return {found_.data(), size_}; }

private:
    bool comes_before(const Excess& a, const Excess& b) const {
        return a.growth > b.growth ||
               (a.growth == b.growth && key(metrics_[a.index]) < key(metrics_[b.index]));
    }

    std::span<const Metric> metrics_;
    std::size_t count_;
    std::size_t size_ = 0;
    std::array<Excess, InteriorPoint::room> found_{};
};

// Calls visit(lane of P, bound, index): P of each metric as seen from H, and an upper bound of its
// greatest eigenvalue.
template <class Visit>
void see_all_from(const Eigen::Matrix3d& h, std::span<const Metric> metrics, const Visit& visit) {
    in_groups(metrics, [&](std::size_t first, std::size_t count, const ConstraintLanes& m) {
        const ConstraintLanes p = seen_from(h, Factorisation(m));
        const ConstraintNumbers bounds = greatest_eigenvalues(p);
        for (std::size_t i = 0; i < count; ++i) {
            const auto lane = static_cast<Eigen::Index>(i);
            visit(p, lane, bounds[lane], first + i);
        }
    });
}

// The metrics that H exceeds most, or touches most closely.
Farthest nearest_to_touch(std::span<const Metric> metrics, const Eigen::Matrix3d& h,
                          std::size_t count) {
    Farthest farthest(metrics, count);
    see_all_from(h, metrics,
                 [&](const ConstraintLanes&, Eigen::Index, double bound, std::size_t index) {
                     farthest.enter(bound, index);
                 });
    return farthest;
}

// The metric that H exceeds most; a growth of 1 if it exceeds none.
Excess worst_excess(std::span<const Metric> metrics, const Eigen::Matrix3d& h) {
    Farthest worst(metrics, 1);
    see_all_from(h, metrics,
                 [&](const ConstraintLanes& p, Eigen::Index lane, double bound, std::size_t index) {
                     if (bound <= 1 || !worst.might_enter(bound)) return;
                     const double growth = eigen_frame(p[lane]).lengths[2];
                     if (growth > 1) worst.enter(growth, index);
                 });
    return worst.found().empty() ? Excess{1, 0} : worst.found()[0];
}

// Whether `m` is within all metrics, up to their rounding.
bool is_within_all(const Metric& m, std::span<const Metric> metrics) {
    constexpr double rounding = 1e-14;
    const Eigen::Matrix3d h = m.matrix();
    bool is_within = true;
    in_groups(metrics, [&](std::size_t, std::size_t count, const ConstraintLanes& lanes) {
        if (!is_within) return;
        const Factorisation factorisation(lanes);
        const ConstraintNumbers allowed =
            1 + rounding * (lanes.xx + lanes.yy + lanes.zz) * factorisation.trace_of_inverse();
        const ConstraintLanes p = seen_from(h, factorisation);
        const ConstraintNumbers most = greatest_eigenvalues(p);
        for (std::size_t i = 0; i < count; ++i) {
            const auto lane = static_cast<Eigen::Index>(i);
            is_within = is_within && (most[lane] <= allowed[lane] ||
                                      eigen_frame(p[lane]).lengths[2] <= allowed[lane]);
        }
    });
    return is_within;
}

OrderFreeIntersection of_pair(std::span<const Metric> pair) {
    const std::uint32_t first = key(pair[0]) < key(pair[1]) ? 0 : 1;
    const Reduction r = reduce(pair[first], pair[1 - first]);
    OrderFreeIntersection answer{.factor = r.half()};
    const auto of = [&](int i) { return r.is_of_first(i) ? 1.0 : 0.0; };
    answer.multiplier[0] = {first, {of(0), of(1), of(2), 0, 0, 0}};
    answer.multiplier[1] = {1 - first, {1 - of(0), 1 - of(1), 1 - of(2), 0, 0, 0}};
    answer.count = 2;
    return answer;
}

// Few of the metrics, in an order that does not depend on that of all.
class CoreSet {
public:
    explicit CoreSet(std::span<const Metric> all) : all_(all) {}

    bool is_full() const { return size_ == InteriorPoint::room; }
    std::size_t size() const { return size_; }
    std::span<const Metric> metrics() const { return {metrics_.data(), size_}; }
    std::size_t index(std::size_t k) const { return indices_[k]; }
    // Or one equal to it: of equal ones the first found would depend on the order.
    bool has(const Metric& metric) const {
        return std::ranges::find(metrics(), metric) != metrics().end();
    }
    void add(std::size_t index) {
        std::size_t place = size_++;
        for (; place > 0 && key(all_[index]) < key(metrics_[place - 1]); --place) {
            move(place - 1, place);
        }
        metrics_[place] = all_[index];
        indices_[place] = index;
    }
    // Leaves those that a certificate needs, given that of a solution.
    void drop(const InteriorPoint& solution);

private:
    void move(std::size_t from, std::size_t to) {
        metrics_[to] = metrics_[from];
        indices_[to] = indices_[from];
    }

    std::span<const Metric> all_;
    std::size_t size_ = 0;
    std::array<Metric, InteriorPoint::room> metrics_;
    std::array<std::size_t, InteriorPoint::room> indices_{};
};

void CoreSet::drop(const InteriorPoint& solution) {
    std::array<Metric, InteriorPoint::room> tensors;
    for (std::size_t k = 0; k < size_; ++k) tensors[k] = solution.multiplier(k);
    const std::uint32_t needed = needed_multipliers({tensors.data(), size_});
    std::size_t size = 0;
    for (std::size_t k = 0; k < size_; ++k) {
        if ((needed >> k & 1) != 0) move(k, size++);
    }
    size_ = size;
}

// The solution of a core set, made smaller until it exceeds the others by no factor.
OrderFreeIntersection made_smaller(const CoreSet& core, const InteriorPoint& solution,
                                   double excess, int steps) {
    const double factor = std::max(excess, 1.0);
    OrderFreeIntersection answer{.factor = solution.factor() / std::sqrt(factor),
                                 .gap = solution.gap() + 3 * std::log(factor),
                                 .steps = steps};
    answer.count = core.size();
    for (std::size_t k = 0; k < core.size(); ++k) {
        answer.multiplier[k] = {static_cast<std::uint32_t>(core.index(k)),
                                1 / factor * solution.multiplier(k)};
    }
    return answer;
}

}  // namespace

Metric OrderFreeIntersection::metric() const {
    // Of one metric the factor is that metric; other symmetric factors may be indefinite.
    const Metric own = Metric::from_matrix(factor);
    return factor == factor.transpose() && is_positive_definite(own) ? own
                                                                     : left_polar_factor(factor);
}

OrderFreeIntersection order_free_intersection(std::span<const Metric> metrics, double tolerance,
                                              const Eigen::Matrix3d* near) {
    static_assert(OrderFreeIntersection::most_multipliers >= InteriorPoint::room);
    const std::size_t smallest = smallest_of_valid(metrics);
    if (is_within_all(metrics[smallest], metrics)) {
        OrderFreeIntersection answer{.factor = metrics[smallest].matrix()};
        answer.multiplier[0] = {static_cast<std::uint32_t>(smallest), Metric::isotropic(1)};
        answer.count = 1;
        return answer;
    }
    if (metrics.size() == 2) return of_pair(metrics);

    CoreSet core(metrics);
    const bool are_few = metrics.size() <= InteriorPoint::room;
    if (are_few && near == nullptr) {
        for (std::size_t i = 0; i < metrics.size(); ++i) core.add(i);
    } else {
        constexpr std::size_t of_many = 8;
        const Eigen::Matrix3d from = near != nullptr ? *near : metrics[smallest].matrix();
        const Farthest nearest =
            nearest_to_touch(metrics, from, are_few ? metrics.size() : of_many);
        const double most = nearest.found()[0].growth;
        constexpr double far = 2;
        if (near != nullptr && !(most < far && most > 1 / far)) {
            return order_free_intersection(metrics, tolerance);
        }
        // Near the answer, what leaves room has no effect.
        constexpr double leaves_room = 0.9;
        const double least = near != nullptr ? leaves_room * most : 0;
        for (const Excess& excess : nearest.found()) {
            if (excess.growth >= least) core.add(excess.index);
        }
    }
    const double of_core = core.size() == metrics.size() ? tolerance : 0.75 * tolerance;
    int steps = 0;
    // A round adds the worst of those left out. Few are needed, but by rounding two may take turns.
    constexpr int most_rounds = 200;
    for (int round = 1;; ++round) {
        InteriorPoint solution(core.metrics(), near);
        solution.solve(of_core);
        steps += solution.steps();
        if (near != nullptr && !(std::abs(solution.gap()) <= of_core)) {  // not near after all
            near = nullptr;
            continue;
        }
        if (core.size() == metrics.size()) return made_smaller(core, solution, 1, steps);
        const Excess worst = worst_excess(metrics, solution.factor());
        if (worst.growth <= 1 || solution.gap() + 3 * std::log(worst.growth) <= tolerance ||
            core.has(metrics[worst.index]) || round == most_rounds) {
            return made_smaller(core, solution, worst.growth, steps);
        }
        if (core.is_full()) core.drop(solution);
        core.add(worst.index);
        near = nullptr;
    }
}

}  // namespace controlspace
