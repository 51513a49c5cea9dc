#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "geometry/point.h"
#include "cones/cone_tree.h"
#include "sources/point_source.h"

namespace controlspace {

/// Lower envelope of the cones h_i + (g-1) |p - Q_i| of isotropic sources: what the exact field of
/// paper §5.2 is where no source is anisotropic. Branch and bound in a bounding-volume hierarchy.
class IsotropicCones {
public:
    /// All metrics must be isotropic, g >= 1.
    IsotropicCones(std::span<const PointSource> sources, double g);

    /// The smallest length of all cones at `p`, or `cap` where none is below it: to the bit the
    /// minimum over all sources of `cone_factor` times the source's length.
    double smallest_length(const Point& p, double cap) const;

private:
    static constexpr std::size_t leaf_size = 16;
    using Lanes = std::array<double, leaf_size>;

    /// A flat cylinder around the positions: sources mostly lie on surfaces, whose tangential
    /// pieces it fits closely where an axis-aligned box does not.
    struct Node {
        Point centre;
        Vector normal;  ///< the axis, of unit length
        double half_thickness;
        double radius;
        double length;  ///< the smallest
    };
    struct Leaf {
        Lanes x{}, y{}, z{}, length{};  ///< infinite lengths fill up the last lanes
    };

    void make_leaf(std::uint32_t node, std::span<const PointSource> sources,
                   std::span<const ConeTreeItem> items);
    void enclose(std::uint32_t node, std::span<const ConeTreeItem> items);
    double lower_bound(const Node& node, const Point& p) const;
    void visit_leaf(const Leaf& leaf, const Point& p, double& smallest) const;

    double g_;
    double slope_;
    double safely_;  ///< just below 1: makes bounds safe against rounding
    ConeTreeShape shape_;
    std::vector<Node> nodes_;
    std::vector<Leaf> leaves_;
};

}  // namespace controlspace
