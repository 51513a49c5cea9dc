// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
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

/// The root holds what is outside of its children as tiles of the same size, however large a leaf
/// is: at this level 16 along each axis in the standard tree.
constexpr int deepest_level = 16;

using Octants = Topology<OctreeNode>;

/// K_oL's tree: its leaves become voxels and tiles.
class Octree : public MetricTree<OctreeNode, LeafMetrics> {
    using Base = MetricTree<OctreeNode, LeafMetrics>;

public:
    explicit Octree(const SpaceOptions& options) : Base(with_indices(options)) {}

    AdaptationReport adapt(const AdaptationGoal& goal) {
        const bool is_free = !options_.octree_depth;
        if (is_free) options_.octree_depth = deepest_level;
        AdaptationReport report = Base::adapt(goal);
        if (is_free) options_.octree_depth.reset();
        if (report.shortfall == depth_shortfall(deepest_level)) {
            report.shortfall = fmt::format(
                "leaves of level {} are not cut, since the root of OpenVDB has no "
                "levels of its own: raise target_delta (within), or choose K_oL",
                deepest_level);
        }
        return report;
    }
    const Octants& octants() const { return topology_; }
    std::span<const Metric> metrics() const { return storage_.metrics().field(); }

    static std::unique_ptr<ControlSpace> finished(const std::shared_ptr<const Octree>& octree,
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
        note(tree, tree.root(), 0);
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
    /// The leaf that holds a place in the domain.
    Box leaf_at(const Point& x, const Box& domain) const {
        Box box = domain;
        std::size_t next = 0;
        for (std::size_t level = 0; cuts_[next++]; ++level) {
            const Subdivision parts =
                OctreeNode::even_subdivision(domain, static_cast<int>(level), box);
            const OctreeNode node(parts);
            int c = 0;
            for (; node.slot(c) != node.child_with(x); ++c) pass(level + 1, next);
            box = parts.child(c);
        }
        return box;
    }
    std::size_t bytes() const {
        return cuts_.capacity() / 8 + children_.capacity() * sizeof(children_[0]);
    }

private:
    void note(const Octants& tree, Ref ref, std::size_t level) {
        cuts_.push_back(!ref.is_leaf());
        if (ref.is_leaf()) return;
        const OctreeNode& node = tree.node(ref);
        if (level == children_.size()) children_.push_back(node.count());
        for (int c = 0; c < node.count(); ++c) {
            note(tree, node.children[node.slot(c)], level + 1);
        }
    }
    // Goes on behind the part that begins at `next`.
    void pass(std::size_t level, std::size_t& next) const {
        if (!cuts_[next++]) return;
        for (int c = 0; c < children_[level]; ++c) pass(level + 1, next);
    }

    std::vector<bool> cuts_;
    std::vector<int> children_;  // of a part that is cut, by level
};

/// The voxel that answers for a place: the one whose leaf the octree would find, on a face the low
/// one.
class VoxelOfPlace {
public:
    VoxelOfPlace(const Box& domain, const Cell& voxels) : domain_(domain), voxels_(voxels) {
        constexpr double epsilon = std::numeric_limits<double>::epsilon();
        for (Axis a = 0; a < 3; ++a) {
            const double n = voxels[static_cast<std::size_t>(a)];
            const double edge = domain.edges()[a];
            per_length_[a] = edge > 0 ? n / edge : 0;
            const double reach = std::max(std::abs(domain.low[a]), std::abs(domain.high[a]));
            near_[a] = 8 * epsilon * (n + reach * per_length_[a]);
        }
    }

    const Box& domain() const { return domain_; }

    [[gnu::always_inline]] Cell operator()(const Point& x) const {
        const double t[3] = {in_voxels(x.x(), 0), in_voxels(x.y(), 1), in_voxels(x.z(), 2)};
        Cell cell{static_cast<std::int32_t>(t[0]), static_cast<std::int32_t>(t[1]),
                  static_cast<std::int32_t>(t[2])};
        for (std::size_t a = 0; a < 3; ++a) {
            if (is_near_face(t[a], cell[a], a)) cell[a] = by_halving(x[static_cast<Axis>(a)], a);
        }
        return cell;
    }
    /// The same of at most CellBatch::most places.
    void locate(std::span<const Point> x, CellBatch& batch) const {
        std::array<bool, CellBatch::most> is_near;
        for (std::size_t a = 0; a < 3; ++a) {
            bool any = false;
            for (std::size_t i = 0; i < x.size(); ++i) {
                const double t = in_voxels(x[i][static_cast<Axis>(a)], a);
                batch.cell[a][i] = static_cast<std::int32_t>(t);
                is_near[i] = is_near_face(t, batch.cell[a][i], a);
                any |= is_near[i];
            }
            for (std::size_t i = 0; any && i < x.size(); ++i) {
                if (is_near[i]) batch.cell[a][i] = by_halving(x[i][static_cast<Axis>(a)], a);
            }
        }
    }

private:
    [[gnu::always_inline]] double in_voxels(double x, std::size_t axis) const {
        const auto a = static_cast<Axis>(axis);
        const double above = x > domain_.low[a] ? x : domain_.low[a];
        const double place = above < domain_.high[a] ? above : domain_.high[a];
        return (place - domain_.low[a]) * per_length_[a];
    }
    // So near that rounding counts: the octree has halved its boxes, and rounded each middle.
    [[gnu::always_inline]] bool is_near_face(double t, std::int32_t voxel, std::size_t a) const {
        const double beyond = t - voxel, near = near_[static_cast<Axis>(a)];
        return (beyond <= near) | (beyond >= 1 - near);
    }
    std::int32_t by_halving(double x, std::size_t axis) const {
        const auto a = static_cast<Axis>(axis);
        double low = domain_.low[a], high = domain_.high[a];
        std::int32_t i = 0;
        for (std::int32_t n = voxels_[axis]; n > 1; n /= 2) {
            const double middle = 0.5 * (low + high);
            const bool is_above = x > middle;
            (is_above ? low : high) = middle;
            i = 2 * i + (is_above ? 1 : 0);
        }
        return i;
    }

    Box domain_;
    Cell voxels_;
    Vector per_length_, near_;
};

/// Bytes of the nodes that voxels and tiles in these boxes take, as the tree counts its memory.
template <class Tree>
std::size_t bytes_for(const std::vector<VoxelBox>& leaves, const Cell& voxels) {
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
    // What lies outside of all children is a tile of the root, in a map.
    constexpr std::size_t root_entry = 80;
    std::size_t in_root = 1;
    for (const std::int32_t n : voxels)
        in_root *= (static_cast<std::size_t>(n) >> Upper::TOTAL) + 1;
    return in_root * root_entry +
           nodes(Leaf::TOTAL) * (sizeof(Leaf) + leaf_values_bytes<Tree>)+nodes(Lower::TOTAL) *
               sizeof(Lower) +
           nodes(Upper::TOTAL) * sizeof(Upper) + sizeof(Tree);
}

/// The metrics of an octree's leaves, stored as `M`, in a tree of OpenVDB: a leaf that is as large
/// as a node becomes a tile, others voxels.
template <class M, class Tree>
class VdbTiles final : public ControlSpace, public HasControlNodes, public Saved {
    using Value = VdbValue<M>;
    static constexpr bool are_lengths = is_stored_length<M>;

public:
    /// A form that is only read, or one that keeps the octree for what comes later.
    VdbTiles(const std::shared_ptr<const Octree>& octree, bool is_only_read)
        : VdbTiles(*octree, VoxelBoxes(octree->octants())) {
        if (!is_only_read) octree_ = octree;
    }

    void sample(std::span<const Point> x, std::span<Metric> out) const override {
        answer(x, out, [](const auto& m) -> Metric { return m; });
    }
    void sample_lengths(std::span<const Point> x, std::span<double> out) const override {
        if constexpr (are_lengths) {
            answer(x, out, [](const auto& m) { return length_of(m); });
        } else {
            ControlSpace::sample_lengths(x, out);
        }
    }
    Metric metric_at(const Point& x) const override { return value_at(voxel_of_(x)); }
    double length_at(const Point& x) const override {
        if constexpr (are_lengths) {
            return length_of(value_at(voxel_of_(x)));
        } else {
            return ControlSpace::length_at(x);
        }
    }
    std::unique_ptr<Cursor> cursor() const override {
        return std::make_unique<PlainCursor<VdbTiles>>(*this);
    }
    Box domain() const override { return voxel_of_.domain(); }

    /// A leaf of the octree, by a walk through all before it.
    std::optional<Box> cell_at(const Point& x) const override {
        return cuts_.leaf_at(nearest_in(domain(), x), domain());
    }

    Footprint footprint() const override {
        Footprint footprint;
        footprint.tree_nodes = tree_.leafCount() + tree_.nonLeafCount();
        footprint.cells = footprint.control_nodes = control_nodes_;  // leaves, as cell_at answers
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
        : voxel_of_(octree.domain(), boxes.voxels),
          cuts_(octree.octants()),
          control_nodes_(boxes.leaves.size()) {
        const std::size_t bytes = bytes_for<Tree>(boxes.leaves, boxes.voxels);
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
    auto value_at(const Cell& voxel) const {
        return reader()(static_cast<std::uint32_t>(voxel[0]), static_cast<std::uint32_t>(voxel[1]),
                        static_cast<std::uint32_t>(voxel[2]));
    }
    // Some at a time, so that values are on their way while those before them are read.
    template <class Value>
    void answer(std::span<const Point> x, std::span<Value> out, const auto& of) const {
        const auto read = reader();
        CellBatch batch;
        std::array<const typename Tree::LeafNodeType*, CellBatch::most> leaves;
        std::array<std::array<const typename VdbValue<M>::Type*, 1>, CellBatch::most> at;
        for (std::size_t first = 0; first < x.size(); first += CellBatch::most) {
            const std::size_t count = std::min(CellBatch::most, x.size() - first);
            voxel_of_.locate(x.subspan(first, count), batch);
            for (std::size_t i = 0; i < count; ++i) leaves[i] = read.prepare(batch[i]);
            for (std::size_t i = 0; i < count; ++i) {
                at[i] = read.template find<1>(batch[i], leaves[i]);
            }
            for (std::size_t i = 0; i < count; ++i) out[first + i] = of(read.metric(at[i], 0));
        }
    }
    /// Of the leaves in depth-first order, as queries read them.
    std::vector<Metric> metrics(const Octants& octants) const {
        std::vector<Metric> metrics;
        metrics.reserve(control_nodes_);
        for (const VoxelBox& leaf : VoxelBoxes(octants).leaves) {
            metrics.push_back(value_at(leaf.low));
        }
        return metrics;
    }

    VoxelOfPlace voxel_of_;
    VdbStored<M> stored_;  // how codes are packed, without items
    Tree tree_{typename Value::Type(0)};
    Cuts cuts_;
    std::size_t control_nodes_;
    std::shared_ptr<const Octree> octree_;
};

std::unique_ptr<ControlSpace> Octree::finished(const std::shared_ptr<const Octree>& octree,
                                               std::optional<Precision> precision) {
    if (!precision) return std::make_unique<VdbTiles<Metric, VdbTree543<VdbMetric>>>(octree, false);
    return with_stored<true>(
        *precision, octree->metrics(),
        [&]<class M>(std::type_identity<M>) -> std::unique_ptr<ControlSpace> {
            using Kept = std::conditional_t<std::is_same_v<M, StoredMetric<double>>, Metric, M>;
            using Number = typename VdbValue<Kept>::Type;
            if constexpr (VdbValue<Kept>::is_code) {
                // In the nodes of the standard tree most of their memory would be pointers.
                using Small = typename openvdb::tree::Tree4<Number, 3, 3, 3>::Type;
                const Cell voxels = VoxelBoxes(octree->octants()).voxels;
                if (std::ranges::max(voxels) <= 512) {
                    return std::make_unique<VdbTiles<Kept, Small>>(octree, true);
                }
            }
            return std::make_unique<VdbTiles<Kept, VdbTree543<Number>>>(octree, true);
        });
}

}  // namespace

std::unique_ptr<ControlSpaceBuilder> make_openvdb_tiles(const SpaceOptions& options) {
    require_valid(options);
    return std::make_unique<SharedBuilder<Octree>>(options);
}

}  // namespace controlspace
