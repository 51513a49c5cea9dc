// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "baselines/openvdb/catalogue.h"
#include "baselines/openvdb/octree_voxels.h"
#include "baselines/openvdb/stored_value.h"
#include "baselines/openvdb/tiles_file.h"
#include "baselines/openvdb/voxel_boxes_tree.h"
#include "controlspace/input_errors.h"
#include "controlspace/space/detail/plain_cursor.h"
#include "controlspace/space/detail/saved.h"
#include "controlspace/space/detail/shared_builder.h"
#include "controlspace/trees/detail/leaf_graph.h"
#include "controlspace/trees/detail/metric_tree.h"
#include "controlspace/trees/leaf_metrics.h"
#include "refuse.h"

namespace controlspace {

namespace {

/// K_oL's tree: its leaves become voxels and tiles.
class Octree : public MetricTree<OctreeNode, LeafMetrics> {
    using Base = MetricTree<OctreeNode, LeafMetrics>;

public:
    explicit Octree(const SpaceOptions& options) : Base(options) {
        // The root holds what is outside of its children as tiles of the same size, however large a
        // leaf is: 16 along each axis of the standard tree then.
        deepest_ = 16;
    }

    const Octants& octants() const { return topology_; }
    std::span<const Metric> metrics() const { return storage_.metrics().field(); }

    static std::unique_ptr<ControlSpace> finished(const std::shared_ptr<const Octree>& octree,
                                                  std::optional<Precision> precision);
    static std::string state_in_vdb(const std::string& bytes, const std::string& file) {
        return state_in_tiles_file(bytes, file);
    }
};

/// The metrics of an octree's leaves, stored as `M`, in a tree of OpenVDB: a leaf that is as large
/// as a node becomes a tile, others voxels.
template <class M, class Tree>
class VdbTiles final : public ControlSpace, public HasControlNodes, public Saved {
    using Value = VdbValue<M>;
    static constexpr bool are_lengths = is_stored_length<M>;

public:
    /// A form that is only read, or one that keeps the octree for what comes later.
    VdbTiles(const std::shared_ptr<const Octree>& octree, const VoxelBoxes& boxes,
             bool is_only_read)
        : voxel_of_(octree->domain(), boxes.voxels),
          cuts_(octree->octants()),
          control_nodes_(boxes.leaves.size()) {
        const double bytes = bytes_for<Tree>(boxes);
        const std::size_t most = octree->options().max_bytes;
        if (bytes > static_cast<double>(most)) {
            fail_too_large(static_cast<std::size_t>(bytes), most);
        }
        const std::span<const Metric> metrics = octree->metrics();
        if constexpr (std::is_same_v<M, Metric>) {
            fill(tree_, boxes, [&](LeafIndex leaf) { return Value::of(metrics[leaf]); });
        } else {
            stored_.emplace(metrics);
            fill(tree_, boxes, [&](LeafIndex leaf) { return Value::of(stored_->items()[leaf]); });
            stored_->drop_items();
        }
        if (!is_only_read) octree_ = octree;
    }

    void sample(std::span<const Point> x, std::span<Metric> out) const override { answer(x, out); }
    void sample_lengths(std::span<const Point> x, std::span<double> out) const override {
        if constexpr (are_lengths) {
            answer(x, out);
        } else {
            ControlSpace::sample_lengths(x, out);
        }
    }
    Metric metric_at(const Point& x) const override { return value_in(voxel_of_(x)); }
    double length_at(const Point& x) const override {
        if constexpr (are_lengths) {
            return length_of(value_in(voxel_of_(x)));
        } else {
            return ControlSpace::length_at(x);
        }
    }
    std::unique_ptr<Cursor> cursor() const override {
        return std::make_unique<PlainCursor<VdbTiles>>(*this);
    }
    Box domain() const override { return voxel_of_.domain(); }

    /// A leaf of the octree.
    std::optional<Box> cell_at(const Point& x) const override {
        if (octree_) return octree_->cell_at(x);
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
    std::string vdb_file(StateWriter state) const override {
        const Octants octants = cuts_.octants(domain());
        const std::vector<Metric> all = metrics(octants);
        if (!std::ranges::all_of(all, is_isotropic)) {
            refuse("tensors are not saved to a .vdb: name a .ctrl");
        }
        // Refuses lengths that are beyond floats.
        const StoredMetrics<StoredLength<float>> stored(all);
        std::vector<float> lengths;
        for (const StoredLength<float>& length : stored.items()) lengths.push_back(length.h);
        return tiles_file(std::move(state), octants, lengths);
    }

private:
    StoredReader<M, Tree> reader() const { return {tree_, vdb_value<M>(stored_)}; }
    auto value_in(const Cell& voxel) const {
        return reader()(static_cast<std::uint32_t>(voxel[0]), static_cast<std::uint32_t>(voxel[1]),
                        static_cast<std::uint32_t>(voxel[2]));
    }
    template <class Answer>
    void answer(std::span<const Point> x, std::span<Answer> out) const {
        const auto read = reader();
        sample_cells<1>(
            x, read, out,
            [&](std::span<const Point> places, CellBatch& batch) {
                voxel_of_.locate(places, batch);
            },
            [&](const auto& at, const CellBatch&, std::size_t) {
                return answer_of<Answer>(read.metric(at, 0));
            });
    }
    /// Of the leaves in depth-first order, as queries read them.
    std::vector<Metric> metrics(const Octants& octants) const {
        std::vector<Metric> metrics;
        metrics.reserve(control_nodes_);
        for (const VoxelBox& leaf : VoxelBoxes(octants).leaves) {
            metrics.push_back(value_in(leaf.low));
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
    const VoxelBoxes boxes(octree->octants());
    if (!precision) {
        return std::make_unique<VdbTiles<Metric, VdbMetricTree>>(octree, boxes, false);
    }
    return with_stored<true>(
        *precision, octree->metrics(),
        [&]<class M>(std::type_identity<M>) -> std::unique_ptr<ControlSpace> {
            using Number = typename VdbValue<OrMetric<M>>::Type;
            if constexpr (VdbValue<OrMetric<M>>::is_code) {
                // In the nodes of the standard tree most of their memory would be pointers.
                using Small = typename openvdb::tree::Tree4<Number, 3, 3, 3>::Type;
                if (std::ranges::max(boxes.voxels) <= 512) {
                    return std::make_unique<VdbTiles<M, Small>>(octree, boxes, true);
                }
            }
            return std::make_unique<VdbTiles<OrMetric<M>, VdbTree543<Number>>>(octree, boxes, true);
        });
}

}  // namespace

std::unique_ptr<ControlSpaceBuilder> make_openvdb_tiles(const SpaceOptions& options) {
    require_valid(options);
    return std::make_unique<SharedBuilder<Octree>>(options);
}

}  // namespace controlspace
