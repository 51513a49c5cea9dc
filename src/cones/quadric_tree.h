#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <span>

#include "cones/tensor_tree.h"
#include "controlspace/sources/point_source.h"

namespace controlspace {

/// Bounds of all sources below each child, for `OrderFreeCones`.
///
/// With A = M^-2 and w = Q - centre, the squared metric distance of a place y,
/// as seen from the centre, is the quadratic function y A y - 2 (A w) y + w A
/// w. The functions of sources that vary smoothly with their places lie near a
/// parallelogram in the space of all quadratic functions: those of a child's
/// sources are
///     middle + s slopes[0] + t slopes[1],    -1 <= s, t <= 1,
/// up to `rest`.
struct QuadricNode {
    /// A number of each child; 0 where there is none.
    using Row = std::array<double, lane_count>;
    /// xx yy zz xy xz yz of A, x y z of b, c.
    using Rows = std::array<Row, 10>;

    std::array<Row, 3> centre{};
    Rows middle{};
    std::array<Rows, 2> slopes{};
    /// xx yy zz xy xz yz of a tensor G, r, c: what is left of A is within -G and
    /// G, and that of q at most y G y + 2 r |y| + c.
    std::array<Row, 8> rest{};
};

using QuadricTree = ConeTree<QuadricNode, TensorLeaf>;

/// Builds a tree over `items`, which are put in order. `lengths` are the
/// smallest of each source, `uncertainty` is theirs.
QuadricTree build_quadric_tree(std::span<ConeTreeItem> items, std::span<const PointSource> sources,
                               std::span<const double> lengths, double uncertainty);

/// A factor H at a place, among cones of slope g - 1.
struct Exceeding {
    Point p;
    double slope;
    Metric square, inverse;  ///< H H^T, and its inverse

    Exceeding(const Point& place, const Eigen::Matrix3d& h, double slope_of_cones);
};

struct ExceededChildren {
    unsigned bits = 0;
    QuadricNode::Row rooms{};  ///< the less, the more the cones are exceeded, roughly
};

/// Children of a node that may have a source whose cone C is exceeded by H:
/// where no eigenvalue of H^T C^-2 H is greater than `limit` for any source,
/// the bit is not set.
ExceededChildren children_exceeded(const QuadricNode& node, const Exceeding& h, double limit);

}  // namespace controlspace
