// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "cones/cone_tree.h"
#include "controlspace/geometry/point.h"
#include "controlspace/metric/metric.h"
#include "metric/tensor_lanes.h"

namespace controlspace {

/// Bounds of all sources below each child, for `OrderFreeCones`.
///
/// With A = M^-2 and w = Q - centre, the squared metric distance of a place y, as seen from the
/// centre, is the quadratic function y A y - 2 (A w) y + w A w. Its ten coefficients vary with the
/// places of the sources; where they do so smoothly, they lie near a quadratic patch in the space
/// of all quadratic functions: those of a child's sources are
///     terms[0] + s terms[1] + t terms[2] + s^2 terms[3] + s t terms[4] + t^2 terms[5],
/// -1 <= s, t <= 1, up to `rest`.
struct QuadricNode {
    static constexpr std::size_t term_count = 6;
    /// A number of each child; 0 where there is none.
    using Row = std::array<double, lane_count>;
    /// xx yy zz xy xz yz of A, x y z of b, c.
    using Rows = std::array<Row, 10>;

    std::array<Row, 3> centre{};
    std::array<Rows, term_count> terms{};
    /// xx yy zz xy xz yz of a tensor G, r, c: what is left of A is within -G and
    /// G, and that of q at most y G y + 2 r |y| + c.
    std::array<Row, 8> rest{};
    Row squared_slope{};    ///< of the least steep cone; slopes are g - 1
    bool is_linear = true;  ///< terms of second order are 0
    std::uint32_t first_child = 0;
    std::uint32_t child_count = 0;
};

/// Eight sources, for a test that is quicker than that of their cones, but squares anisotropy.
struct QuadricLeaf {
    using Row = QuadricNode::Row;
    VectorLanes position;
    std::array<Row, 6> terms{};  ///< xx yy zz xy xz yz of M^-2; 0 where there is no source
    Row doubt{};                 ///< what rounding leaves in doubt of any of them
    Row squared_slope{};         ///< of the cone
};

/// Sets the bounds of a child to those of `items`; `inverse_squares` are M^-2 of all sources,
/// `uncertainty` is that of their lengths, relative.
void set_child(QuadricNode& node, std::size_t child, std::span<const ConeTreeItem> items,
               std::span<const Metric> inverse_squares, double uncertainty);

/// A factor H at a place.
struct Exceeding {
    Point p;
    Eigen::Matrix3d factor;  ///< H
    Metric inverse;          ///< of H H^T, or a little less

    Exceeding(const Point& place, const Eigen::Matrix3d& h);
};

struct ExceededChildren {
    unsigned bits = 0;
    QuadricNode::Row rooms{};  ///< the less, the more the cones are exceeded, roughly
};

/// Children of a node that may have a source whose cone C is exceeded by H:
/// where no eigenvalue of H^T C^-2 H is greater than `limit` for any source,
/// the bit is not set.
ExceededChildren children_exceeded(const QuadricNode& node, const Exceeding& h, double limit);

/// The same of sources: false only if none of their cones is exceeded by more than `limit`.
bool may_exceed(const QuadricLeaf& leaf, const Exceeding& h, double limit);

}  // namespace controlspace
