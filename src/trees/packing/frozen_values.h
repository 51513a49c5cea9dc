#pragma once

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "controlspace/metric/stored_metric.h"
#include "controlspace/space/control_nodes.h"
#include "controlspace/trees/detail/corners.h"
#include "controlspace/trees/detail/leaf_graph.h"
#include "trees/packing/frozen_tree.h"
#include "trees/topology/leaf_faces.h"
#include "trees/topology/parts_across.h"
#include "trees/values/quadratic_in_leaves.h"
#include "trees/values/trilinear_in_leaves.h"

namespace controlspace {

// What the leaves of compact forms hold (PackedTree), and save(state): as the storage does whose
// compact form it is. `M` is what metrics are stored as, `Plane` the type of the numbers of
// planes.

/// Metrics of nodes, and leaves, of which each has its `faces` as numbers of planes.
template <class M, class Leaf>
class FrozenLeaves {
public:
    static constexpr bool are_lengths = is_stored_length<M>;

    FrozenLeaves(CutPlanes planes, std::vector<M> metrics)
        : planes_(std::move(planes)), metrics_(std::move(metrics)) {}

    void prefetch(LeafIndex leaf) const { __builtin_prefetch(&leaves_[leaf]); }
    [[gnu::always_inline]] Box box(LeafIndex leaf) const {
        return leaves_[leaf].faces.box(planes_);
    }
    void describe(Footprint& footprint) const {
        footprint.control_nodes = metrics_.size();
        footprint.bytes_payload = metrics_.capacity() * sizeof(M);
        footprint.bytes_topology += leaves_.capacity() * sizeof(Leaf) + planes_.bytes();
    }

protected:
    void save_metrics(StateWriter& state) const {
        NodeMetrics::exchange(NodeMetrics({metrics_.begin(), metrics_.end()}), state);
    }

    CutPlanes planes_;
    std::vector<M> metrics_;
    std::vector<Leaf> leaves_;
};

template <class Plane>
struct QuadraticLeaf {
    Faces<Plane> faces;
    PartsAcross across;
};

/// One metric a leaf, interpolated with those of the neighbours.
template <class M, class Plane>
class FrozenQuadratic : public FrozenLeaves<M, QuadraticLeaf<Plane>> {
    using Base = FrozenLeaves<M, QuadraticLeaf<Plane>>;
    using Base::planes_, Base::metrics_, Base::leaves_;

public:
    template <class Node>
    FrozenQuadratic(const Topology<Node>& tree, CutPlanes planes, std::vector<M> metrics,
                    const QuadraticRule& rule)
        : Base(std::move(planes), std::move(metrics)), rule_(rule) {
        leaves_.reserve(tree.leaves());
        for_each_faces<Plane>(tree, planes_, [&](LeafIndex, const Faces<Plane>& faces) {
            leaves_.push_back({faces, {}});
        });
        for_each_parts_across(tree, [&](LeafIndex leaf, const Box&, const PartsAcross& across) {
            leaves_[leaf].across = across;
        });
        isotropic_ = std::ranges::all_of(
            metrics_, [](const M& m) { return is_stored_length<M> || is_isotropic(m); });
    }

    template <class Node, class Value>
    void values_in(const Topology<Node>& tree, std::span<const LeafIndex> leaves,
                   std::span<const Point> x, std::span<Value> out) const {
        QuadraticInLeaves(tree, *this).interpolate(leaves, x, out);
    }

    const PartsAcross& parts_across(LeafIndex leaf, const Point&) const {
        return leaves_[leaf].across;
    }
    Metric metric(LeafIndex leaf) const { return metrics_[leaf]; }
    void prefetch_metric(LeafIndex leaf) const { __builtin_prefetch(&metrics_[leaf]); }
    double length(LeafIndex leaf) const { return length_of(metrics_[leaf]); }
    bool all_isotropic() const { return isotropic_; }
    double slope() const { return rule_.slope; }
    QuadraticForm form() const { return rule_.form; }

    template <class Node>
    ControlNodes control_nodes(const Topology<Node>& tree, Neighbourhood neighbourhood) const {
        return {leaf_graph(tree, neighbourhood).graph, {metrics_.begin(), metrics_.end()}};
    }
    void save(StateWriter& state) const {
        this->save_metrics(state);
        state("quadratic.slope", rule_.slope);
    }

private:
    QuadraticRule rule_;
    bool isotropic_;
};

template <class Plane>
struct VertexLeaf {
    Corners corners;
    Faces<Plane> faces;
};

/// A metric at each vertex, trilinear between the eight of a leaf; vertices numbered as the leaves
/// come to them.
template <class M, class Plane>
class FrozenVertices : public FrozenLeaves<M, VertexLeaf<Plane>> {
    using Base = FrozenLeaves<M, VertexLeaf<Plane>>;
    using Base::planes_, Base::metrics_, Base::leaves_;

public:
    /// `corners` are those of the tree's leaves, whose numbers point into `metrics`.
    template <class Node>
    FrozenVertices(const Topology<Node>& tree, CutPlanes planes,
                   const std::vector<Corners>& corners, std::vector<M> metrics)
        : Base(std::move(planes), std::move(metrics)) {
        leaves_.reserve(tree.leaves());
        for_each_faces<Plane>(tree, planes_, [&](LeafIndex leaf, const Faces<Plane>& faces) {
            leaves_.push_back({corners[leaf], faces});
        });
    }

    template <class Node, class Value>
    void values_in(const Topology<Node>&, std::span<const LeafIndex> leaves,
                   std::span<const Point> x, std::span<Value> out) const {
        trilinear_in_leaves(*this, leaves, x, out);
    }
    const Corners& corners(LeafIndex leaf) const { return leaves_[leaf].corners; }
    std::span<const M> metrics() const { return metrics_; }

    template <class Node>
    ControlNodes control_nodes(const Topology<Node>& tree, Neighbourhood neighbourhood) const {
        const std::vector<Corners> corners = all_corners();
        return {
            vertex_graph(corners, vertex_positions(tree, corners, metrics_.size()), neighbourhood),
            {metrics_.begin(), metrics_.end()}};
    }
    void save(StateWriter& state) const {
        this->save_metrics(state);
        state("vertices.of_leaves", all_corners());
    }

private:
    std::vector<Corners> all_corners() const {
        std::vector<Corners> corners;
        corners.reserve(leaves_.size());
        for (const auto& leaf : leaves_) corners.push_back(leaf.corners);
        return corners;
    }
};

}  // namespace controlspace
