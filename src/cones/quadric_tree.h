#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "cones/tensor_tree.h"
#include "controlspace/sources/point_source.h"

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
    bool is_linear = true;  ///< terms of second order are 0
    std::uint32_t first_child = 0;
    std::uint32_t child_count = 0;
};

/// Bounding-volume hierarchy over sources, with up to eight children a node, nearly all of which
/// are there. The root is node 0; the children of a node follow one another; leaves have the
/// numbers after the nodes.
class QuadricTree {
public:
    QuadricTree() = default;
    /// Puts `items` in order. `lengths` are the smallest of each source, `uncertainty` is theirs.
    /// Runs on all of TBB's threads; the tree does not depend on their number.
    QuadricTree(std::span<ConeTreeItem> items, std::span<const PointSource> sources,
                std::span<const double> lengths, double uncertainty);

    /// Sources of a leaf, but for the last, and vectors of eight of them.
    static constexpr std::uint32_t vectors_of_leaf = 2;
    static constexpr std::uint32_t leaf_size = lane_count * vectors_of_leaf;

    bool empty() const { return vectors_.empty(); }
    bool is_leaf(std::uint32_t number) const { return number >= nodes_.size(); }
    const QuadricNode& node(std::uint32_t number) const { return nodes_[number]; }
    /// The number of the leaf that has a source, given its place in the order.
    std::uint32_t leaf_of(std::uint32_t place) const {
        return static_cast<std::uint32_t>(nodes_.size()) + place / leaf_size;
    }
    /// The first vector of a leaf.
    std::uint32_t first_vector(std::uint32_t number) const {
        return vectors_of_leaf * (number - static_cast<std::uint32_t>(nodes_.size()));
    }
    /// The root is its own parent.
    std::uint32_t parent(std::uint32_t number) const { return parents_[number]; }
    /// All sources in order, eight in each.
    std::span<const TensorLeaf> vectors() const { return vectors_; }
    /// Indices of the sources, in order.
    std::span<const std::uint32_t> indices() const { return indices_; }
    std::size_t bytes() const;

private:
    std::vector<QuadricNode> nodes_;
    std::vector<TensorLeaf> vectors_;
    std::vector<std::uint32_t> parents_;  ///< of nodes and leaves
    std::vector<std::uint32_t> indices_;
};

/// A factor H at a place, among cones of slope g - 1.
struct Exceeding {
    Point p;
    double slope;
    Metric inverse;  ///< of H H^T, or a little less

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
