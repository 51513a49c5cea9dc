// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <type_traits>
#include <utility>
#include <vector>

#include "baselines/openvdb/catalogue.h"
#include "baselines/openvdb/stored_value.h"
#include "controlspace/input_errors.h"
#include "controlspace/space/detail/plain_cursor.h"
#include "controlspace/space/detail/saved.h"
#include "controlspace/space/detail/shared_builder.h"
#include "controlspace/trees/detail/leaf_graph.h"
#include "controlspace/trees/detail/metric_tree.h"
#include "controlspace/trees/leaf_metrics.h"

namespace controlspace {

namespace {

/// As deep as the coordinates of OpenVDB have bits, but for their sign and a last one beyond.
constexpr int deepest_level = 30;

using Octants = Topology<OctreeNode>;

/// K_oL's tree: its leaves become voxels and tiles.
class Octree : public MetricTree<OctreeNode, LeafMetrics> {
    using Base = MetricTree<OctreeNode, LeafMetrics>;

public:
    explicit Octree(SpaceOptions options) : Base(with_indices(options)) {}

    AdaptationReport adapt(const AdaptationGoal& goal) {
        options_.octree_depth = options_.octree_depth.value_or(deepest_level);
        return Base::adapt(goal);
    }
    const Octants& octants() const { return topology_; }
    std::span<const Metric> metrics() const { return storage_.metrics().field(); }

    static std::unique_ptr<ControlSpace> finished(std::shared_ptr<const Octree> octree,
                                                  std::optional<Precision> precision);

private:
    static SpaceOptions with_indices(SpaceOptions options) {
        if (options.octree_depth)
            options.octree_depth = std::min(*options.octree_depth, deepest_level);
        return options;
    }
};

/// A leaf of the octree as a box of voxels of its finest leaves.
struct VoxelBox {
    Cell low, edges;

    openvdb::CoordBBox bounds() const {
        return {{low[0], low[1], low[2]},
                {low[0] + edges[0] - 1, low[1] + edges[1] - 1, low[2] + edges[2] - 1}};
    }
};

/// The leaves in depth-first order, and the voxels along each axis.
struct VoxelBoxes {
    std::vector<VoxelBox> leaves;
    Cell voxels;

    explicit VoxelBoxes(const Octants& tree) {
        leaves.reserve(tree.leaves());
        visit(tree, tree.root(), {{0, 0, 0}, {0, 0, 0}});
        std::array<int, 3> most{};
        for (const VoxelBox& leaf : leaves) {
            for (std::size_t a = 0; a < 3; ++a) most[a] = std::max(most[a], leaf.edges[a]);
        }
        for (std::size_t a = 0; a < 3; ++a) voxels[a] = 1 << most[a];
        for (VoxelBox& leaf : leaves) {
            for (std::size_t a = 0; a < 3; ++a) {
                const int halvings = leaf.edges[a];
                leaf.low[a] <<= most[a] - halvings;
                leaf.edges[a] = 1 << (most[a] - halvings);
            }
        }
    }

private:
    // Here the edges are still numbers of halvings, and low counts boxes of that size.
    void visit(const Octants& tree, Ref ref, const VoxelBox& box) {
        if (ref.is_leaf()) {
            leaves.push_back(box);
            return;
        }
        const OctreeNode& node = tree.node(ref);
        for (int c = 0; c < node.count(); ++c) {
            const std::size_t slot = node.slot(c);
            VoxelBox child = box;
            for (std::size_t a = 0; a < 3; ++a) {
                if (!node.cuts(a)) continue;
                ++child.edges[a];
                child.low[a] = 2 * child.low[a] + static_cast<std::int32_t>(slot >> a & 1);
            }
            visit(tree, node.children[slot], child);
        }
    }
};

/// Which parts of an octree are cut, depth first: enough to make it again.
class Cuts {
public:
    explicit Cuts(const Octants& tree) {
        cuts_.reserve(tree.leaves() + tree.inner_nodes());
        note(tree, tree.root());
    }
    /// The octree, its leaves numbered depth first.
    Octants octants(const Box& domain) const {
        std::vector<OctreeNode> nodes;
        std::size_t next = 0;
        LeafIndex leaves = 0;
        const auto make = [&](const auto& self, const Box& box, int level) -> Ref {
            if (!cuts_[next++]) return Ref::leaf(leaves++);
            const Subdivision parts = OctreeNode::even_subdivision(domain, level, box);
            const std::size_t n = nodes.size();
            nodes.emplace_back(parts);
            for (int c = 0; c < parts.children(); ++c) {
                const Ref child = self(self, parts.child(c), level + 1);
                nodes[n].set_child(nodes[n].slot(c), child);
            }
            return Ref::inner(n);
        };
        make(make, domain, 0);
        return {domain, std::move(nodes)};
    }
    std::size_t bytes() const { return cuts_.capacity() / 8; }

private:
    void note(const Octants& tree, Ref ref) {
        cuts_.push_back(!ref.is_leaf());
        if (ref.is_leaf()) return;
        const OctreeNode& node = tree.node(ref);
        for (int c = 0; c < node.count(); ++c) note(tree, node.children[node.slot(c)]);
    }

    std::vector<bool> cuts_;
};

/// Bytes of the nodes that voxels and tiles in these boxes take, as the tree counts its memory.
template <class Tree>
std::size_t bytes_for(std::span<const VoxelBox> leaves) {
    using Leaf = typename Tree::LeafNodeType;
    using Upper = typename Tree::RootNodeType::ChildNodeType;
    using Lower = typename Upper::ChildNodeType;
    // Nodes of 2^total voxels a side that hold a part of a box smaller than they are.
    const auto nodes = [&](unsigned total) {
        std::vector<Cell> origins;
        for (const VoxelBox& leaf : leaves) {
            if (std::ranges::min(leaf.edges) >> total > 0) continue;
            Cell from = leaf.low, to = leaf.low;
            for (std::size_t a = 0; a < 3; ++a) {
                from[a] >>= total;
                to[a] = (leaf.low[a] + leaf.edges[a] - 1) >> total;
            }
            for (Cell at = from; at[0] <= to[0]; ++at[0]) {
                for (at[1] = from[1]; at[1] <= to[1]; ++at[1]) {
                    for (at[2] = from[2]; at[2] <= to[2]; ++at[2]) {
                        if (origins.empty() || origins.back() != at) origins.push_back(at);
                    }
                }
            }
        }
        std::ranges::sort(origins);
        const auto again = std::ranges::unique(origins);
        return static_cast<std::size_t>(again.begin() - origins.begin());
    };
    return nodes(Leaf::TOTAL) * (sizeof(Leaf) + leaf_values_bytes<Tree>)+nodes(Lower::TOTAL) *
               sizeof(Lower) +
           nodes(Upper::TOTAL) * sizeof(Upper) + sizeof(Tree);
}

/// The metrics of an octree's leaves, stored as `M`, in a tree of OpenVDB: a leaf that is as large
/// as a node becomes a tile, others voxels.
template <class M>
class VdbTiles final : public ControlSpace, public HasControlNodes, public Saved {
    using Value = VdbValue<M>;
    // Codes are small: in the nodes of the standard tree most of its memory would be pointers.
    using Tree =
        std::conditional_t<Value::is_code,
                           typename openvdb::tree::Tree4<typename Value::Type, 3, 3, 3>::Type,
                           VdbTree543<typename Value::Type>>;
    static constexpr bool are_lengths = is_stored_length<M>;

public:
    /// A form that is only read, or one that keeps the octree for what comes later.
    VdbTiles(const std::shared_ptr<const Octree>& octree, bool is_only_read)
        : VdbTiles(*octree, VoxelBoxes(octree->octants())) {
        if (!is_only_read) octree_ = octree;
    }

    void sample(std::span<const Point> x, std::span<Metric> out) const override {
        stencil_.template sample<Metric>(x, reader(), out);
    }
    void sample_lengths(std::span<const Point> x, std::span<double> out) const override {
        if constexpr (are_lengths) {
            stencil_.template sample<double>(x, reader(), out);
        } else {
            ControlSpace::sample_lengths(x, out);
        }
    }
    Metric metric_at(const Point& x) const override {
        return stencil_.template at<Metric>(x, reader());
    }
    double length_at(const Point& x) const override {
        if constexpr (are_lengths) {
            return stencil_.template at<double>(x, reader());
        } else {
            return ControlSpace::length_at(x);
        }
    }
    std::unique_ptr<Cursor> cursor() const override {
        return std::make_unique<PlainCursor<VdbTiles>>(*this);
    }
    Box domain() const override { return stencil_.domain(); }

    /// A voxel, or a tile.
    std::optional<Box> cell_at(const Point& x) const override {
        CellBatch batch;
        stencil_.locate({&x, 1}, batch);
        const Cell cell = batch[0];
        const int depth = tree_.getValueDepth({cell[0], cell[1], cell[2]});
        const std::int32_t edge = depth <= 0   ? Upper::DIM
                                  : depth == 1 ? Lower::DIM
                                  : depth == 2 ? Leaf::DIM
                                               : 1;
        Cell low, last;
        for (std::size_t a = 0; a < 3; ++a) {
            low[a] = cell[a] & ~(edge - 1);
            const auto voxels = static_cast<std::int32_t>(stencil_.cells()[static_cast<Axis>(a)]);
            last[a] = std::min(low[a] + edge, voxels) - 1;
        }
        return stencil_.widened({stencil_.box_of(low).low, stencil_.box_of(last).high}, x);
    }

    Footprint footprint() const override {
        Footprint footprint;
        footprint.tree_nodes = tree_.leafCount() + tree_.nonLeafCount();
        footprint.cells = tree_.leafCount() * Leaf::SIZE + tree_.activeTileCount();
        footprint.control_nodes = control_nodes_;
        footprint.depth = Tree::DEPTH - 1;
        add_dense_bytes(tree_, footprint);
        if (stored_) footprint.bytes_payload += stored_->bytes();
        footprint.bytes_auxiliary = cuts_.bytes();
        if (octree_) footprint.bytes_auxiliary += octree_->footprint().bytes_total();
        if (given()) footprint.bytes_auxiliary += given()->bytes();
        if (tree_.root().getTableSize() > 1) {
            footprint.remark = fmt::format("{} upper nodes, which a query finds by the root",
                                           tree_.root().getTableSize());
        }
        return footprint;
    }
    /// Those of the octree.
    ControlNodes control_nodes(Neighbourhood neighbourhood) const override {
        if (octree_) return octree_->control_nodes(neighbourhood);
        const Octants octants = cuts_.octants(domain());
        return {leaf_graph(octants, neighbourhood).graph, metrics(octants)};
    }
    /// As the octree is saved.
    void save(StateWriter& state) const override {
        if (octree_) return octree_->save(state);
        const Octants octants = cuts_.octants(domain());
        controlspace::save(octants, state);
        NodeMetrics::exchange(saved_metrics<M>(metrics(octants)), state);
    }

private:
    using Leaf = typename Tree::LeafNodeType;
    using Upper = typename Tree::RootNodeType::ChildNodeType;
    using Lower = typename Upper::ChildNodeType;

    VdbTiles(const Octree& octree, const VoxelBoxes& boxes)
        : stencil_(octree.domain(), Vector(boxes.voxels[0], boxes.voxels[1], boxes.voxels[2])),
          cuts_(octree.octants()),
          control_nodes_(boxes.leaves.size()) {
        const std::size_t bytes = bytes_for<Tree>(boxes.leaves);
        if (bytes > octree.options().max_bytes) fail_too_large(bytes, octree.options().max_bytes);
        std::vector<LeafIndex> order;
        octree.octants().depth_first(order);
        const std::span<const Metric> metrics = octree.metrics();
        if constexpr (std::is_same_v<M, Metric>) {
            fill(boxes, [&](std::size_t i) { return Value::of(metrics[order[i]]); });
        } else {
            stored_.emplace(metrics, order);
            fill(boxes, [&](std::size_t i) { return Value::of(stored_->items()[i]); });
            stored_->drop_items();
        }
    }
    void fill(const VoxelBoxes& boxes, const auto& value_of_leaf) {
        for (std::size_t i = 0; i < boxes.leaves.size(); ++i) {
            tree_.fill(boxes.leaves[i].bounds(), value_of_leaf(i));
        }
    }
    StoredReader<M, Tree> reader() const { return {tree_, vdb_value<M>(stored_)}; }
    /// Of the leaves in depth-first order, as queries read them.
    std::vector<Metric> metrics(const Octants& octants) const {
        const auto read = reader();
        std::vector<Metric> metrics;
        metrics.reserve(control_nodes_);
        for (const VoxelBox& leaf : VoxelBoxes(octants).leaves) {
            const auto [i, j, k] = leaf.low;
            metrics.push_back(read(static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(j),
                                   static_cast<std::uint32_t>(k)));
        }
        return metrics;
    }

    NearestStencil stencil_;
    VdbStored<M> stored_;  // how codes are packed, without items
    Tree tree_{typename Value::Type(0)};
    Cuts cuts_;
    std::size_t control_nodes_;
    std::shared_ptr<const Octree> octree_;
};

std::unique_ptr<ControlSpace> Octree::finished(std::shared_ptr<const Octree> octree,
                                               std::optional<Precision> precision) {
    if (!octree->is_finished()) {
        const auto copy = std::make_shared<Octree>(*octree);
        copy->finish();
        octree = copy;
    }
    if (!precision) return std::make_unique<VdbTiles<Metric>>(octree, false);
    return with_stored<true>(
        *precision, octree->metrics(),
        [&]<class M>(std::type_identity<M>) -> std::unique_ptr<ControlSpace> {
            using Kept = std::conditional_t<std::is_same_v<M, StoredMetric<double>>, Metric, M>;
            return std::make_unique<VdbTiles<Kept>>(octree, true);
        });
}

}  // namespace

std::unique_ptr<ControlSpaceBuilder> make_openvdb_tiles(const SpaceOptions& options) {
    require_valid(options);
    return std::make_unique<SharedBuilder<Octree>>(options);
}

}  // namespace controlspace
