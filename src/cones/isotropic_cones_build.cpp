// SPDX-License-Identifier: Apache-2.0
#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

#include "cones/isotropic_cones.h"
#include "controlspace/sources/cone.h"
#include "geometry/extent_of.h"

namespace controlspace {

// Which sources cannot matter
// ---------------------------
// Let source j meet the length of source i at i's place: k = h_j + s_j |Q_i - Q_j| <= h_i. Then for
// every p, by the triangle inequality,
//     h_j + s_j |p - Q_j| <= k + s_j |p - Q_i|.
// If j is no steeper than i, s_j <= s_i, this is not above h_i + s_i |p - Q_i|. If it is, it is not
// as long as that is not above the cap, provided that k + s_j T <= cap where h_i + s_i T = cap. In
// both cases i is nowhere smaller than j where it matters, and may be left out. Where "<=" holds by
// more than some margin this goes from i to j to j's own dominator and on, lengths getting strictly
// smaller, and ends at a source that is kept: so all may be left out at once. Computed lengths
// below the cap are off by less than 32 epsilon of the cap; by a margin of more than twice that,
// leaving out does not change a bit of any answer. Of sources at one place the smallest is kept,
// without any margin, and others that are less steep.

namespace {

constexpr double epsilon = std::numeric_limits<double>::epsilon();
constexpr double infinity = std::numeric_limits<double>::infinity();

// Unit vector along which the items spread least. Any unit vector is right, this one is fast.
Vector normal_of(std::span<const ConeTreeItem> items, const Point& centre, double extent) {
    if (!(extent > 0)) return Vector::UnitX();
    Vector sum = Vector::Zero();
    Eigen::Matrix3d moments = Eigen::Matrix3d::Zero();
    for (const ConeTreeItem& item : items) {
        const Vector v = (item.position() - centre) / extent;
        sum += v;
        moments += v * v.transpose();
    }
    moments -= sum * sum.transpose() / static_cast<double>(items.size());
    Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
    solver.computeDirect(moments);
    const Vector normal = solver.eigenvectors().col(0).normalized();
    return std::abs(normal.squaredNorm() - 1) < 4 * epsilon ? normal : Vector::UnitX();
}

double slope_of(const PointSource& source, double g) { return cone_growth(source, g) - 1; }

IsotropicCone cone_of(const PointSource& source, double g) {
    return {source.position, source.metric.xx, slope_of(source, g)};
}

// For each place the item of the smallest length there, and longer ones that are less steep, in an
// order that depends on nothing else.
void keep_smallest_at_each_place(std::vector<ConeTreeItem>& items, const SourceColumns& sources,
                                 double g) {
    const auto slope = [&](const ConeTreeItem& item) { return slope_of(sources[item.index], g); };
    tbb::parallel_sort(items.begin(), items.end(), [&](const auto& a, const auto& b) {
        // Sources are far away in memory: only of the same place are they looked at.
        if (a.coordinates != b.coordinates) return a.coordinates < b.coordinates;
        return std::tuple(slope(a), a.index) < std::tuple(slope(b), b.index);
    });
    const auto end =
        std::unique(items.begin(), items.end(), [&](const ConeTreeItem& a, const ConeTreeItem& b) {
            return a.position() == b.position() && slope(a) <= slope(b);
        });
    items.erase(end, items.end());
}

// Around the positions of items; there must be one.
struct Cylinder {
    Point centre;
    Vector normal;
    double half_thickness, radius;

    explicit Cylinder(std::span<const ConeTreeItem> items) {
        const Box extent = extent_of(items, &ConeTreeItem::position);
        centre = extent.centre();
        normal = normal_of(items, centre, extent.edges().maxCoeff());
        double least = infinity;
        double most = -infinity;
        for (const ConeTreeItem& item : items) {
            const double along = normal.dot(item.position() - centre);
            least = std::min(least, along);
            most = std::max(most, along);
        }
        centre += 0.5 * (least + most) * normal;
        double thickness = 0;
        double squared_radius = 0;
        for (const ConeTreeItem& item : items) {
            const Vector v = item.position() - centre;
            const double along = normal.dot(v);
            thickness = std::max(thickness, std::abs(along));
            squared_radius = std::max(squared_radius, (v - along * normal).squaredNorm());
        }
        const double rounding = 64 * epsilon * extent.edges().norm();
        half_thickness = thickness + rounding;
        radius = std::sqrt(squared_radius) + rounding;
    }
};

}  // namespace

IsotropicCones::IsotropicCones(const SourceColumns& sources, double g, double cap)
    : steepest_(largest_growth(sources, g) - 1),
      cap_(cap),
      // A cone's length is computed as h (1 + (g-1) |v / h|), its bounds as h + (g-1) |v|; the two
      // differ by a few roundings, and the bounds give way by more. Without growth, by none.
      safely_(steepest_ > 0 ? 1 - 64 * epsilon : 1) {
    // Without growth cones differ in their lengths only.
    const double weight = g > 1 ? 1 / (g - 1) : 1;
    std::vector<ConeTreeItem> items(sources.size());
    for (std::size_t i = 0; i < sources.size(); ++i) {
        const PointSource& source = sources[i];
        const Point& q = source.position;
        items[i] = {{q.x(), q.y(), q.z(), weight * source.metric.xx},
                    static_cast<std::uint32_t>(i)};
    }
    keep_smallest_at_each_place(items, sources, g);
    const std::size_t kept = build_without_dominated(
        items, [&](std::span<ConeTreeItem> some) { build(some, sources, g); },
        [&](const ConeTreeItem& item) { return is_dominated(cone_of(sources[item.index], g)); });
    dropped_ = sources.size() - kept;
}

bool IsotropicCones::is_dominated(const IsotropicCone& cone) const {
    const double margin = 128 * epsilon * cap_;
    const double below = cone.length - margin;
    const auto is_below = [&](double at_cone, double slope) {
        if (!(at_cone < below)) return false;
        if (slope <= cone.slope) return true;
        return at_cone + slope * (cap_ - cone.length) / cone.slope <= cap_ - margin;
    };
    // Steeper sources that all rise above the cap, or too near to it, are passed over together.
    const double reach = (cap_ - cone.length) / cone.slope;
    const auto bounds = [&](const Node& node) -> Lanes {
        const Lanes least = lower_bounds(node, cone.position);
        const auto rise_above =
            node.slope > cone.slope && least + node.slope * reach > cap_ - margin;
        return rise_above.select(Lanes::Constant(infinity), least);
    };
    return !tree_.search([&] { return below; }, bounds,
                         [&](std::uint32_t number) {
                             const Leaf& leaf = tree_.leaf(number);
                             const LanesOf<leaf_size> roughly = leaf.lengths_at(cone.position);
                             for (Eigen::Index i = 0; i < leaf_size; ++i) {
                                 if (!(safely_ * roughly[i] < below)) continue;
                                 const double length = leaf[i].exact_length_at(cone.position);
                                 if (is_below(length, leaf.slope[i])) return false;
                             }
                             return true;
                         });
}

void IsotropicCones::build(std::span<ConeTreeItem> items, const SourceColumns& sources, double g) {
    const auto make_leaf = [&](std::span<const ConeTreeItem> of_leaf, Leaf& leaf) {
        Eigen::Index lane = 0;
        for (const ConeTreeItem& item : of_leaf) leaf.set(lane++, cone_of(sources[item.index], g));
    };
    // Lanes without a source or a child have infinite lengths.
    const auto least_slope = [&](std::uint32_t number) -> double {
        const auto least = [](const auto& of) {
            return (of.length < infinity).select(of.slope, infinity).minCoeff();
        };
        return tree_.is_leaf(number) ? least(tree_.leaf(number)) : least(tree_.node(number));
    };
    const auto make_node = [&](std::span<const Tree::Child> children, Node& node, std::uint32_t) {
        for (std::size_t i = 0; i < children.size(); ++i) {
            const auto& [number, of_child] = children[i];
            if (of_child.empty()) continue;
            const auto lane = static_cast<Eigen::Index>(i);
            const Cylinder cylinder(of_child);
            node.centre.set(lane, cylinder.centre);
            node.normal.set(lane, cylinder.normal);
            node.half_thickness[lane] = cylinder.half_thickness;
            node.radius[lane] = cylinder.radius;
            node.length[lane] = tree_.is_leaf(number) ? tree_.leaf(number).length.minCoeff()
                                                      : tree_.node(number).length.minCoeff();
            node.slope[lane] = least_slope(number);
        }
    };
    tree_.build(items, leaf_size, make_leaf, make_node);
}

}  // namespace controlspace
