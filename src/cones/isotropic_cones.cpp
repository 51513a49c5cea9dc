// SPDX-License-Identifier: Apache-2.0
#include "cones/isotropic_cones.h"

#include <algorithm>
#include <cmath>
#include <span>

namespace controlspace {

namespace {

constexpr auto from_root = [](auto& waiting, double) { waiting.add_root(); };

}  // namespace

Lanes IsotropicCones::Node::distances(const Point& p) const {
    const auto [x, y, z] = displacements(centre, p);
    const Lanes along = x * normal.x + y * normal.y + z * normal.z;
    const Lanes across = ((x - along * normal.x).square() + (y - along * normal.y).square() +
                          (z - along * normal.z).square())
                             .sqrt();
    const Lanes above = (along.abs() - half_thickness).max(0);
    const Lanes beside = (across - radius).max(0);
    return (above.square() + beside.square()).sqrt();
}

Lanes IsotropicCones::lower_bounds(const Node& node, const Point& p, double radius) const {
    return safely_ * (node.length + node.slope * (node.distances(p) - radius).max(0));
}

void IsotropicCones::visit_leaf(Hint index, const Point& p, double& smallest, Hint& hint) const {
    // First as bounds have them, all lanes: only those near to the least may have the smallest.
    const Leaf& leaf = tree_.leaves()[index];
    const LanesOf<leaf_size> lengths = leaf.lengths_at(p);
    const double least = lengths.minCoeff();
    if (!(safely_ * least < smallest)) return;
    const double doubtful = least / (safely_ * safely_);
    for (Eigen::Index i = 0; i < leaf_size; ++i) {
        if (!(lengths[i] <= doubtful)) continue;
        const double length = leaf[i].exact_length_at(p);
        if (length < smallest) {
            smallest = length;
            hint = index;
        }
    }
}

std::optional<std::uint32_t> IsotropicCones::source_below(const Point& p, double length,
                                                          Hint& hint) const {
    const double smallest = search(p, length, 0, hint);
    if (!(smallest < length)) return std::nullopt;
    return source_of(p, smallest, hint);
}

Eigen::Index IsotropicCones::lane_of(const Point& p, double smallest, Hint leaf) const {
    Eigen::Index lane = 0;
    while (tree_.leaves()[leaf][lane].exact_length_at(p) != smallest) ++lane;
    return lane;
}

double IsotropicCones::search(const Point& p, double cap, double tolerance, Hint& hint) const {
    return search(
        cap, tolerance, hint, from_root, [&](const Node& node) { return lower_bounds(node, p); },
        [&](Hint leaf, double& smallest) { visit_leaf(leaf, p, smallest, hint); });
}

double IsotropicCones::smallest_length(const Point& p, const Nearby& nearby, Hint& hint) const {
    return search(
        cap_, 0, hint,
        [&](Tree::Waiting& waiting, double below) {
            for (std::size_t first = 0; first < nearby.size; first += lane_count) {
                waiting.add(lower_bounds(nearby.bounds[first / lane_count], p), below,
                            [&](std::uint32_t c) { return nearby.numbers[first + c]; });
            }
        },
        [&](const Node& node) { return lower_bounds(node, p); },
        [&](Hint leaf, double& smallest) { visit_leaf(leaf, p, smallest, hint); });
}

// With c the centre of the box and R half its diagonal, a source Q is no nearer to any place in it
// than |c - Q| - R, and its farthest place is the corner opposite, at sqrt(|c - Q|^2 + R^2) at
// least: with the half edges e, the sum of (|c - Q|_a + e_a)^2. The centre is rounded: the half
// edges reach from there to both faces, which counts where a box is a few doubles wide.
IsotropicCones::Range IsotropicCones::range_in(const Box& box, Hint& hint) const {
    const Point centre = box.centre();
    const Vector half = (box.high - centre).cwiseMax(centre - box.low);
    const double radius = half.norm();
    using Numbers = LanesOf<leaf_size>;
    // The smallest length below `cap` at distances made by of_node from those between the nodes and
    // the centre, and by of_leaf from those between the sources and the centre along an axis.
    const auto smallest_at = [&](double cap, const auto& of_node, const auto& of_leaf) {
        return search(
            cap, 0, hint, from_root,
            [&](const Node& node) -> Lanes {
                return safely_ * (node.length + node.slope * of_node(node.distances(centre)));
            },
            [&](Hint index, double& smallest) {
                const Leaf& leaf = tree_.leaves()[index];
                const Numbers x = of_leaf((leaf.position.x - centre.x()).abs(), half.x());
                const Numbers y = of_leaf((leaf.position.y - centre.y()).abs(), half.y());
                const Numbers z = of_leaf((leaf.position.z - centre.z()).abs(), half.z());
                const Numbers away = (x.square() + y.square() + z.square()).sqrt();
                const double least = (leaf.length + leaf.slope * away).minCoeff();
                if (!(least < smallest)) return;
                smallest = least;
                hint = index;
            });
    };
    const double most = smallest_at(
        cap_, [&](const Lanes& away) -> Lanes { return (away.square() + radius * radius).sqrt(); },
        [](const Numbers& away, double edge) -> Numbers { return away + edge; });
    const double least = smallest_at(
        most, [&](const Lanes& away) -> Lanes { return (away - radius).max(0); },
        [](const Numbers& away, double edge) -> Numbers { return (away - edge).max(0); });
    return {least, most};
}

// The smallest of what `visit_leaf` lowers the length to, below `cap`, or up to the fraction
// `tolerance` more. It starts at the hint; begin(waiting, length) adds what may hold less.
template <class Begin, class LowerBounds, class VisitLeaf>
double IsotropicCones::search(double cap, double tolerance, Hint& hint, const Begin& begin,
                              const LowerBounds& lower_bounds, const VisitLeaf& visit_leaf) const {
    if (tree_.empty()) return cap;
    const double enough = 1 / (1 + tolerance);
    double smallest = cap;
    const Hint first = std::min(hint, static_cast<Hint>(tree_.leaves().size() - 1));
    visit_leaf(first, smallest);
    Tree::Waiting waiting;
    begin(waiting, enough * smallest);
    tree_.search(
        waiting, [&] { return enough * smallest; }, lower_bounds,
        [&](std::uint32_t number) {
            const Hint leaf = tree_.leaf_number(number);
            if (leaf != first) visit_leaf(leaf, smallest);
            return true;
        });
    return smallest;
}

}  // namespace controlspace
