// SPDX-License-Identifier: Apache-2.0
// What a box needs: the cones that are the smallest in it, or the nodes above them, found once.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>

#include "cones/cone_cover.h"
#include "cones/isotropic_cones.h"
#include "geometry/extent_of.h"

namespace controlspace {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
// Of lengths, as a fraction: a cone that is longer than another by more is not the smallest.
constexpr double beyond_rounding = 256 * std::numeric_limits<double>::epsilon();

}  // namespace

std::optional<IsotropicCone> IsotropicCones::cover_by_one(const Box& box, double tolerance,
                                                          ConeCover& cover, Hint& hint) const {
    const Point centre = box.centre();
    const double smallest = smallest_length(centre, hint);
    cover.reset(box, cap_, tolerance);
    if (!(smallest < cap_)) return std::nullopt;
    const Eigen::Index lane = lane_of(centre, smallest, hint);
    const IsotropicCone cone = tree_.leaves()[hint][lane];
    cover.choose(source_in(hint, lane), cone);
    return cone;
}

template <class Add>
bool IsotropicCones::add_uncovered(std::uint32_t number, const ConeCover& cover,
                                   const Add& add) const {
    const Leaf& leaf = tree_.leaf(number);
    const auto covered = cover.covered(leaf);
    for (Eigen::Index i = 0; i < leaf_size; ++i) {
        if (!covered[i] && !add(source_in(tree_.leaf_number(number), i), leaf[i])) return false;
    }
    return true;
}

bool IsotropicCones::cover(const Box& box, double tolerance, ConeCover& cover, Hint& hint) const {
    cover_by_one(box, tolerance, cover, hint);
    const Point centre = box.centre();
    const auto give = [&](std::uint32_t source, const IsotropicCone& cone) {
        return cover.give(source, cone);
    };
    return tree_.search([] { return infinity; },
                        [&](const Node& node) { return node.uncovered(cover, centre); },
                        [&](std::uint32_t number) { return add_uncovered(number, cover, give); }) &&
           cover.complete();
}

// With R half the diagonal of a box, the cone that is the smallest at its centre is longer by (g-1)
// R at most at any place in it: what is above that at all places is nowhere the smallest.
bool IsotropicCones::gather(const Box& box, ConeList& nearby, Hint& hint) const {
    constexpr int most_leaves = 32;
    nearby.clear();
    const Point p = box.centre();
    const double radius = box.half_diagonal();
    ConeCover cover;
    double reach = cap_;
    if (const auto cone = cover_by_one(box, -beyond_rounding, cover, hint)) {
        nearby.add(*cone);
        reach = cone->exact_length_at(p) + cone->slope * radius;
    }
    const double beyond = std::nextafter(reach / (safely_ * safely_), infinity);
    int leaves = 0;
    return tree_.search([&] { return beyond; },
                        [&](const Node& node) { return lower_bounds(node, p, radius); },
                        [&](std::uint32_t number) {
                            const auto add = [&](std::uint32_t, const IsotropicCone& cone) {
                                nearby.add(cone);
                                return true;
                            };
                            return ++leaves <= most_leaves && add_uncovered(number, cover, add);
                        });
}

void IsotropicCones::Nearby::add(std::uint32_t number, const Node& parent, Eigen::Index child) {
    const auto lane = static_cast<Eigen::Index>(size % lane_count);
    Node& own = bounds[size / lane_count];
    if (lane == 0) own = Node();
    own.centre.set(lane, parent.centre[child]);
    own.normal.set(lane, parent.normal[child]);
    own.half_thickness[lane] = parent.half_thickness[child];
    own.radius[lane] = parent.radius[child];
    own.length[lane] = parent.length[child];
    own.slope[lane] = parent.slope[child];
    numbers[size++] = number;
}

bool IsotropicCones::find_nearby(std::span<const Point> places, Nearby& nearby, Hint& hint) const {
    if (tree_.leaves().size() < 2) return false;
    const Point centre = extent_of(places).centre();
    double radius = 0;
    for (const Point& p : places) {
        const double distance = (p - centre).norm();
        if (!std::isfinite(distance)) return false;
        radius = std::max(radius, distance);
    }
    // The cone that is the smallest at the centre is no longer than this at any of the places.
    const double reach = std::min(cap_, smallest_length(centre, hint) + steepest_ * radius);
    const double beyond = std::nextafter(reach / (safely_ * safely_), infinity);
    Nearby below;
    // Returns false where there is no room.
    const auto add_children = [&](std::uint32_t number) {
        const Node& node = tree_.node(number);
        const Lanes bounds = lower_bounds(node, centre, radius);
        for (std::uint32_t c = 0; c < Tree::arity; ++c) {
            if (!(bounds[c] < beyond)) continue;
            if (below.size == Nearby::room) return false;
            below.add(tree_.first_child(number) + c, node, c);
        }
        return true;
    };
    add_children(0);
    do {
        nearby = below;
        below.size = 0;
    } while (nearby.size > 0 && !tree_.is_leaf(nearby.numbers[0]) &&
             std::ranges::all_of(std::span(nearby.numbers).first(nearby.size), add_children));
    return true;
}

void IsotropicCones::smallest_lengths(std::span<const Point> x, std::span<double> lengths,
                                      Hint& hint) const {
    constexpr std::size_t together = 32;
    Nearby nearby;
    for (std::size_t first = 0; first < x.size(); first += together) {
        const auto part = x.subspan(first, std::min(together, x.size() - first));
        const bool is_found = find_nearby(part, nearby, hint);
        for (std::size_t i = 0; i < part.size(); ++i) {
            lengths[first + i] =
                is_found ? smallest_length(part[i], nearby, hint) : smallest_length(part[i], hint);
        }
    }
}

}  // namespace controlspace
