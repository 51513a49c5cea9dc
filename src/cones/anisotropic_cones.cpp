#include "cones/anisotropic_cones.h"

#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <bit>
#include <limits>
#include <tuple>
#include <utility>

#include "cones/cone.h"
#include "controlspace/metric/intersection.h"
#include "metric/decompose.h"
#include "metric/running_intersection.h"

namespace controlspace {

// What makes leaving out safe
// ---------------------------
// Write A <= B for "the tensor of lengths A is within B": |A u| <= |B u| for all u, that is,
// B^2 - A^2 is positive semidefinite; then |A^-1 v| >= |B^-1 v| for all v. Let X be what has been
// accumulated, C_i = M_i f_i the cone of source i at p, f_i = 1 + (g-1) |M_i^-1 (p - Q_i)|.
//
// 1. Intersecting X with C_i leaves X as it is if X <= C_i. X only ever gets smaller, so a cone
//    that X is within once may be dropped at once, whatever its place in the order.
// 2. Where no length of X exceeds the smallest length of C_i, X <= C_i. Cones come by their
//    smallest length, so the first such one ends the search.
// 3. A node keeps L with L <= M_i for all its sources, and V, such that |V v| <= |M_i^-1 v|. Both
//    are intersections: of the M_i, and of their inverses. With c the node's centre and
//    R = max |V (Q_i - c)|, the triangle inequality gives
//        |M_i^-1 (p - Q_i)| >= |V (p - c)| - |V (Q_i - c)| >= |V (p - c)| - R,
//    hence f_i >= f = 1 + (g-1) max(0, |V (p - c)| - R). No cone of the node is shorter than
//    f min_i (smallest length of M_i), and L f <= C_i for all i: if X <= L f, drop the node.
//
// Which sources cannot matter
// ---------------------------
// Source i may be left out if a source j has C_j < C_i wherever C_i is shorter than the cap in any
// direction: there the smallest length of C_j is less, so C_j comes first, and by 1. C_i changes
// nothing any more; elsewhere it changes nothing by 2. Lengths get strictly smaller from i to j to
// j's own dominator and on, so all such sources may be left out at once.
// Let v = p - Q_i, t = (g-1) |M_i^-1 v|, k = f_j(Q_i), and r = max |M_j^-1 u| / |M_i^-1 u| over all
// u, the growth from M_j to M_i. Then
//     C_i = (1 + t) M_i,    C_j <= (k + (g-1) |M_j^-1 v|) M_j <= (k + r t) M_j,
// by the triangle inequality. C_i matters for t < T = cap / (smallest length of M_i) - 1 only, and
// (k + r t) / (1 + t) is monotonous in t, so it is at most s = max(k, (k + r T) / (1 + T)):
//     s M_j < M_i    is enough.
// Of equal sources at one place all but the first change nothing, and are left out too.
//
// Rounding: a length computed from a tensor of anisotropy k is uncertain by some k epsilon, more so
// where thirty tensors have been intersected on the way to the root; bounds give way by that much
// (`uncertainty_`), so that in doubt a cone is intersected.

namespace {

constexpr double epsilon = std::numeric_limits<double>::epsilon();

// Whether factor * b2 - a2 is positive definite beyond doubt, as in room_below.
bool is_below(const Metric& a2, double factor, const Metric& b2) {
    const double doubt = 64 * epsilon * factor * (b2.xx + b2.yy + b2.zz);
    const double xx = factor * b2.xx - a2.xx - doubt;
    const double yy = factor * b2.yy - a2.yy - doubt;
    const double zz = factor * b2.zz - a2.zz - doubt;
    if (!(xx > 0 && yy > 0 && zz > 0)) return false;
    return Cholesky(
               {xx, yy, zz, factor * b2.xy - a2.xy, factor * b2.xz - a2.xz, factor * b2.yz - a2.yz})
        .is_positive_definite();
}

}  // namespace

AnisotropicCones::AnisotropicCones(std::span<const PointSource> sources, double g, double cap)
    : g_(g), cap_(cap) {
    std::vector<double> lengths(sources.size());
    std::vector<double> anisotropies(sources.size());
    tbb::parallel_for(std::size_t{0}, sources.size(), [&](std::size_t i) {
        const auto of_source = eigen_frame(sources[i].metric).lengths;
        lengths[i] = of_source[0];
        anisotropies[i] = of_source[2] / of_source[0];
    });
    double anisotropy = 1;
    for (const double a : anisotropies) anisotropy = std::max(anisotropy, a);
    uncertainty_ = std::min(4096 * epsilon * anisotropy, 1.0);
    for (const double length : lengths) least_length_ = std::min(least_length_, length);

    const double weight = g_ > 1 ? 1 / (g_ - 1) : 1;
    std::vector<ConeTreeItem> items(sources.size());
    for (std::size_t i = 0; i < sources.size(); ++i) {
        const Point& q = sources[i].position;
        items[i] = {{q.x(), q.y(), q.z(), weight * lengths[i]}, static_cast<std::uint32_t>(i)};
    }
    const auto source_of = [&](const ConeTreeItem& item) -> const PointSource& {
        return sources[item.index];
    };
    const auto key = [&](const ConeTreeItem& item) {
        const auto& [q, m] = source_of(item);
        return std::tie(q.x(), q.y(), q.z(), m.xx, m.yy, m.zz, m.xy, m.xz, m.yz, item.index);
    };
    tbb::parallel_sort(
        items.begin(), items.end(),
        [&](const ConeTreeItem& a, const ConeTreeItem& b) { return key(a) < key(b); });
    const auto end = std::unique(
        items.begin(), items.end(),
        [&](const ConeTreeItem& a, const ConeTreeItem& b) { return source_of(a) == source_of(b); });
    items.erase(end, items.end());
    const std::size_t kept = build_without_dominated(
        items,
        [&](std::span<ConeTreeItem> some) { tree_ = build_tensor_tree(some, sources, lengths); },
        [&](const ConeTreeItem& item) {
            return is_dominated(source_of(item), lengths[item.index]);
        });
    dropped_ = sources.size() - kept;
}

bool AnisotropicCones::is_dominated(const PointSource& source, double length) const {
    const double certain = 1 - uncertainty_;
    const double reach = std::max(0.0, cap_ / length - 1);
    const Point& q = source.position;
    const Metric squared = square(source.metric);
    const auto by = [&](const PointSource& other) {
        const double k = cone_factor(other, g_, q);
        const auto is_within = [&](double factor) {
            const double safe = factor / certain;
            return is_below(safe * safe * square(other.metric), 1, squared);
        };
        if (!is_within(k)) return false;
        const double r = growth(source.metric, other.metric);
        return is_within(std::max(k, (k + r * reach) / (1 + reach)));
    };
    const auto does_not_dominate = [&](std::uint32_t number) {
        const TensorLeaf& leaf = tree_.leaf(number);
        const Lanes lengths = factors(leaf, q) * leaf.length;
        for (int lane = 0; lane < lane_count; ++lane) {
            if (!(lengths[lane] < certain * length)) continue;
            if (by({leaf.position[lane], leaf.metric[lane]})) return false;
        }
        return true;
    };
    return !tree_.search(
        [&] { return certain * length; },
        [&](const TensorNode& node) -> Lanes { return least_factors(node, q) * node.length; },
        does_not_dominate);
}

Lanes AnisotropicCones::least_factors(const TensorNode& node, const Point& p) const {
    const Lanes away = lengths_of_products(node.inverse, displacements(node.centre, p));
    return 1 + (g_ - 1) * ((1 - uncertainty_) * away - (1 + uncertainty_) * node.radius).max(0.0);
}

Lanes AnisotropicCones::factors(const TensorLeaf& leaf, const Point& p) const {
    return 1 + (g_ - 1) * metric_lengths(leaf.metric, displacements(leaf.position, p));
}

Metric AnisotropicCones::intersect(const Point& p, const Metric& largest, double tolerance,
                                   Search& search, std::vector<std::uint32_t>* governing) const {
    if (tree_.empty()) return largest;
    const double certain = 1 - uncertainty_;
    const double enough = certain * (1 + tolerance);
    RunningIntersection found(largest);
    auto& [queue, cones, batch] = search;

    // Lanes where what has been found may be longer than `factors` times the metrics.
    const auto may_matter = [&](const Lanes& factors, const TensorLanes& squares,
                                const Lanes& shortest) {
        const Pivots room = room_below(found.square(), (enough * factors).square(), squares);
        unsigned lanes = 0;
        for (int lane = 0; lane < lane_count; ++lane) {
            const bool matters =
                enough * shortest[lane] < found.longest() && !room.are_positive(lane);
            lanes |= (matters ? 1u : 0u) << lane;
        }
        return lanes;
    };
    const auto open_node = [&](std::uint32_t n) {
        const TensorNode& node = tree_.node(n);
        const std::uint32_t first_child = tree_.first_child(n);
        const Lanes factor = least_factors(node, p);
        const Lanes shortest = certain * factor * node.length;
        for (unsigned lanes = may_matter(factor, node.square, shortest); lanes != 0;
             lanes &= lanes - 1) {
            const auto lane = static_cast<std::uint32_t>(std::countr_zero(lanes));
            queue.push(shortest[lane], 0, first_child + lane);
        }
    };
    const auto open_leaf = [&](std::uint32_t n) {
        const TensorLeaf& leaf = tree_.leaf(n);
        const std::size_t first_item = std::size_t{tree_.leaf_number(n)} * lane_count;
        const Lanes factor = factors(leaf, p);
        for (unsigned lanes = may_matter(factor, square(leaf.metric), factor * leaf.length);
             lanes != 0; lanes &= lanes - 1) {
            const int lane = std::countr_zero(lanes);
            const Metric metric = leaf.metric[lane];
            // As the definition computes it: of like cones the last bit decides which comes first.
            const double exactly = is_axis_aligned(metric)
                                       ? cone_factor({leaf.position[lane], metric}, g_, p)
                                       : factor[lane];
            queue.push(exactly * leaf.length[lane],
                       1 + tree_.indices()[first_item + static_cast<std::size_t>(lane)],
                       static_cast<std::uint32_t>(cones.size()));
            cones.push_back(exactly * metric);
        }
    };
    const auto changes_nothing = [&](const LengthQueue::Waiting& cone) {
        return enough * cone.length >= found.longest() ||
               is_below(found.square(), enough * enough, square(cones[cone.place]));
    };

    cones.clear();
    const double least = certain * std::min(least_length_, found.longest());
    queue.reset(least, found.longest());
    queue.push(least, 0, 0);
    while (queue.advance()) {
        // The cones of a node are in its bucket or a later one: with all nodes of the bucket
        // opened, all cones of the bucket are known.
        batch.clear();
        while (queue.has_more()) {
            const LengthQueue::Waiting next = queue.take();
            if (next.rank > 0) {
                if (!changes_nothing(next)) batch.push_back(next);
            } else if (enough * next.length >= found.longest()) {
                continue;
            } else if (tree_.is_leaf(next.place)) {
                open_leaf(next.place);
            } else {
                open_node(next.place);
            }
        }
        std::sort(batch.begin(), batch.end());
        for (const LengthQueue::Waiting& next : batch) {
            if (changes_nothing(next)) continue;
            if (found.shorten_to(cones[next.place]) && governing != nullptr) {
                governing->push_back(next.rank - 1);
            }
        }
    }
    return found.metric();
}

}  // namespace controlspace
