// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <type_traits>
#include <utility>
#include <vector>

#include "trees/packing/frozen_leaves.h"
#include "trees/packing/frozen_tree.h"
#include "trees/topology/leaf_vertices.h"
#include "trees/values/trilinear_cursor.h"

namespace controlspace {

namespace {

/// Whether leaves hold the metrics at their corners themselves: they take no more bytes than their
/// numbers.
template <class M>
constexpr bool in_leaves = sizeof(typename Packing<M>::Item) <= sizeof(NodeIndex);

template <class M, class Plane>
struct VertexLeaf {
    std::conditional_t<in_leaves<M>, std::array<typename Packing<M>::Item, 8>, Corners> corners;
    Faces<Plane> faces;
};

/// A metric at each vertex, trilinear between the eight of a leaf.
template <class M, class Plane>
class FrozenVertices : public FrozenLeaves<M, VertexLeaf<M, Plane>> {
    using Base = FrozenLeaves<M, VertexLeaf<M, Plane>>;
    using Base::planes_, Base::metrics_, Base::leaves_;

public:
    /// `corners` are those of the tree's leaves, whose numbers point into `metrics`.
    template <class Node>
    FrozenVertices(const Topology<Node>& tree, CutPlanes planes,
                   const std::vector<Corners>& corners, StoredMetrics<M> metrics)
        : Base(std::move(planes), std::move(metrics)), vertices_(metrics_.size()) {
        leaves_.reserve(tree.leaves());
        for_each_faces<Plane>(tree, planes_, [&](LeafIndex leaf, const Faces<Plane>& faces) {
            leaves_.push_back(VertexLeaf<M, Plane>{{}, faces});
            VertexLeaf<M, Plane>& added = leaves_.back();
            for (std::size_t c = 0; c < 8; ++c) {
                if constexpr (in_leaves<M>) {
                    added.corners[c] = metrics_.items()[corners[leaf][c]];
                } else {
                    added.corners[c] = corners[leaf][c];
                }
            }
        });
        if constexpr (in_leaves<M>) metrics_.drop_items();
    }

    template <class Node, class Value>
    void values_in(const Topology<Node>&, std::span<const LeafIndex> leaves,
                   std::span<const Point> x, std::span<Value> out) const {
        trilinear_in_leaves(*this, leaves, x, out);
    }
    template <class Node>
    std::unique_ptr<Cursor> cursor(const Topology<Node>& tree) const {
        return std::make_unique<TrilinearCursor<Node, const FrozenVertices&>>(tree, *this);
    }
    auto at_corners(LeafIndex leaf) const {
        const auto& corners = leaves_[leaf].corners;
        if constexpr (in_leaves<M>) {
            return [&corners, packing = metrics_.packing()](std::size_t c) -> decltype(auto) {
                return packing(corners[c]);
            };
        } else {
            return AtCorners<M>{corners, metrics_.items().data()};
        }
    }

    template <class Node>
    ControlNodes control_nodes(const Topology<Node>& tree, Neighbourhood neighbourhood) const {
        const std::vector<Corners> corners = all_corners(tree);
        return {vertex_graph(corners, vertex_positions(tree, corners, vertices_), neighbourhood),
                metrics_of(corners)};
    }
    template <class Node>
    void save(const Topology<Node>& tree, StateWriter& state) const {
        const std::vector<Corners> corners = all_corners(tree);
        NodeMetrics::exchange(saved_metrics<M>(metrics_of(corners)), state);
        state("vertices.of_leaves", corners);
    }
    void describe(Footprint& footprint) const {
        Base::describe(footprint);
        footprint.control_nodes = vertices_;
        if constexpr (in_leaves<M>) {
            const std::size_t bytes = leaves_.size() * sizeof(leaves_[0].corners);
            footprint.bytes_payload += bytes;
            footprint.bytes_topology -= bytes;
        }
    }

private:
    // Numbers of vertices, found anew where leaves hold none.
    template <class Node>
    std::vector<Corners> all_corners(const Topology<Node>& tree) const {
        if constexpr (in_leaves<M>) {
            return leaf_vertices(tree).of_leaves;
        } else {
            std::vector<Corners> corners;
            corners.reserve(leaves_.size());
            for (const auto& leaf : leaves_) corners.push_back(leaf.corners);
            return corners;
        }
    }
    std::vector<Metric> metrics_of(const std::vector<Corners>& corners) const {
        if constexpr (in_leaves<M>) {
            std::vector<Metric> metrics(vertices_);
            for (LeafIndex leaf = 0; leaf < leaves_.size(); ++leaf) {
                for (std::size_t c = 0; c < 8; ++c) {
                    metrics[corners[leaf][c]] = metrics_.packing()(leaves_[leaf].corners[c]);
                }
            }
            return metrics;
        } else {
            return metrics_.metrics();
        }
    }

    std::size_t vertices_;
};

}  // namespace

template <class Node>
std::unique_ptr<ControlSpace> freeze_vertices(const Topology<Node>& tree,
                                              std::span<const Corners> corners,
                                              std::span<const Metric> metrics,
                                              Precision precision) {
    std::vector<LeafIndex> leaves;
    Topology<Node> ordered = tree.depth_first(leaves);
    // Vertices in the order in which the leaves come to them.
    constexpr NodeIndex unknown = ~NodeIndex{0};
    std::vector<NodeIndex> new_number(metrics.size(), unknown);
    std::vector<NodeIndex> vertices;
    std::vector<Corners> ordered_corners;
    vertices.reserve(metrics.size());
    ordered_corners.reserve(leaves.size());
    for (const LeafIndex leaf : leaves) {
        Corners renumbered = corners[leaf];
        for (NodeIndex& vertex : renumbered) {
            NodeIndex& number = new_number[vertex];
            if (number == unknown) {
                number = static_cast<NodeIndex>(vertices.size());
                vertices.push_back(vertex);
            }
            vertex = number;
        }
        ordered_corners.push_back(renumbered);
    }
    CutPlanes planes(ordered);
    return with_stored<true>(precision, metrics, [&]<class M>(std::type_identity<M>) {
        return with_plane(planes, [&]<class Plane>(Plane) {
            FrozenVertices<M, Plane> values(ordered, std::move(planes), ordered_corners,
                                            StoredMetrics<M>(metrics, vertices));
            return frozen(std::move(ordered), std::move(values));
        });
    });
}

template std::unique_ptr<ControlSpace> freeze_vertices(const Topology<KdNode>&,
                                                       std::span<const Corners>,
                                                       std::span<const Metric>, Precision);
template std::unique_ptr<ControlSpace> freeze_vertices(const Topology<OctreeNode>&,
                                                       std::span<const Corners>,
                                                       std::span<const Metric>, Precision);

}  // namespace controlspace
