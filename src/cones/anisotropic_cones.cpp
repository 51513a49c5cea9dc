// SPDX-License-Identifier: Apache-2.0
#include "cones/anisotropic_cones.h"

#include <algorithm>
#include <bit>
#include <limits>
#include <utility>

#include "cones/undominated.h"
#include "controlspace/sources/cone.h"
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
// Rounding: a length computed from a tensor of anisotropy k is uncertain by some k epsilon, more so
// where thirty tensors have been intersected on the way to the root; bounds give way by that much
// (`uncertainty_`), so that in doubt a cone is intersected.

AnisotropicCones::AnisotropicCones(std::span<const PointSource> sources, double g, double cap)
    : AnisotropicCones(undominated_sources(sources, g, cap)) {}

AnisotropicCones::AnisotropicCones(UndominatedSources sources)
    : dropped_(sources.dropped),
      uncertainty_(sources.uncertainty),
      tree_(std::move(sources.tree)) {}

Metric AnisotropicCones::intersect(const Point& p, const Metric& largest, double tolerance,
                                   Search& search, std::vector<std::uint32_t>* governing) const {
    if (tree_.empty()) return largest;
    const double certain = 1 - uncertainty_;
    const double enough = certain * (1 + tolerance);
    RunningIntersection found(largest);
    auto& [queue, cones] = search;
    constexpr auto comes_after = [](const Waiting& a, const Waiting& b) {
        return a.comes_after(b);
    };
    const auto push = [&](double length, std::uint32_t rank, std::uint32_t place) {
        queue.push_back({length, rank, place});
        std::push_heap(queue.begin(), queue.end(), comes_after);
    };
    const auto pop = [&] {
        std::pop_heap(queue.begin(), queue.end(), comes_after);
        const Waiting first = queue.back();
        queue.pop_back();
        return first;
    };

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
        const Lanes factor = least_cone_factors(node, uncertainty_, p);
        const Lanes shortest = certain * factor * node.length;
        for (unsigned lanes = may_matter(factor, node.square, shortest); lanes != 0;
             lanes &= lanes - 1) {
            const auto lane = static_cast<std::uint32_t>(std::countr_zero(lanes));
            push(shortest[lane], 0, first_child + lane);
        }
    };
    const auto open_leaf = [&](std::uint32_t n) {
        const TensorLeaf& leaf = tree_.leaf(n);
        const std::size_t first_item = std::size_t{tree_.leaf_number(n)} * lane_count;
        const Lanes factor = cone_factors(leaf, p);
        for (unsigned lanes = may_matter(factor, square(leaf.metric), factor * leaf.length);
             lanes != 0; lanes &= lanes - 1) {
            const int lane = std::countr_zero(lanes);
            const PointSource source = leaf[lane];
            // As the definition computes it: of like cones the last bit decides which comes first.
            const double exactly =
                is_axis_aligned(source.metric) ? cone_factor(source, 1, p) : factor[lane];
            push(exactly * leaf.length[lane],
                 1 + tree_.indices()[first_item + static_cast<std::size_t>(lane)],
                 static_cast<std::uint32_t>(cones.size()));
            cones.push_back(exactly * source.metric);
        }
    };
    queue.clear();
    cones.clear();
    push(0, 0, 0);
    // The cones of a node come after it: where a cone is the first of all that waits, those met
    // later are longer.
    while (!queue.empty()) {
        const Waiting next = pop();
        if (enough * next.length >= found.longest()) break;
        if (next.rank == 0) {
            if (tree_.is_leaf(next.place)) {
                open_leaf(next.place);
            } else {
                open_node(next.place);
            }
            continue;
        }
        const Metric& cone = cones[next.place];
        if (is_below(found.square(), enough * enough, square(cone))) continue;
        if (found.shorten_to(cone) && governing != nullptr) governing->push_back(next.rank - 1);
    }
    return found.metric();
}

}  // namespace controlspace
