#include <utility>
#include <vector>

#include "trees/packing/frozen_leaves.h"
#include "trees/packing/frozen_tree.h"
#include "trees/values/trilinear_cursor.h"

namespace controlspace {

namespace {

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
    template <class Node>
    std::unique_ptr<Cursor> cursor(const Topology<Node>& tree) const {
        return std::make_unique<TrilinearCursor<Node, const FrozenVertices&>>(tree, *this);
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
                                            stored_metrics<M>(metrics, vertices));
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
