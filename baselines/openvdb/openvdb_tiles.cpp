// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <memory>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "baselines/openvdb/catalogue.h"
#include "baselines/openvdb/octree_file.h"
#include "baselines/openvdb/octree_form.h"
#include "baselines/openvdb/stored_value.h"
#include "baselines/openvdb/voxel_boxes_tree.h"
#include "refuse.h"
#include "space/plain_cursor.h"
#include "space/shared_builder.h"
#include "trees/metric_tree.h"
#include "trees/packing/packed_tree.h"
#include "trees/topology/leaf_graph.h"
#include "trees/values/constant_values.h"

namespace controlspace {

namespace {

/// K_oL's tree: its leaves become voxels and tiles.
class Octree : public MetricTree<OctreeNode> {
    using Base = MetricTree<OctreeNode>;

public:
    explicit Octree(const SpaceOptions& options)
        : Base(options, [](const SpaceOptions& of) -> std::unique_ptr<LeafModel<OctreeNode>> {
              return std::make_unique<ConstantValues<OctreeNode>>(of);
          }) {
        // The root holds what is outside of its children as tiles of the same size, however large a
        // leaf is: 16 along each axis of the standard tree then.
        deepest_ = 16;
    }

    const Octants& octants() const { return topology_; }
    std::span<const Metric> metrics() const { return model().metrics().field(); }

    static std::unique_ptr<ControlSpace> finished(const std::shared_ptr<const Octree>& octree,
                                                  std::optional<Precision> precision);
};

/// The metrics of an octree's leaves, stored as `M`, in a tree of OpenVDB: a leaf that is as large
/// as a node becomes a tile, others voxels.
template <class M, class Tree>
class VdbTiles final : public OctreeForm<Octree> {
    using Base = OctreeForm<Octree>;
    using Value = VdbValue<M>;
    static constexpr bool are_lengths = is_stored_length<M>;

public:
    /// A form that is only read, or one that keeps the octree for what comes later.
    VdbTiles(const std::shared_ptr<const Octree>& octree, const VoxelBoxes& boxes,
             bool is_only_read)
        : Base(octree, boxes.voxels, Cuts(octree->octants()), is_only_read),
          control_nodes_(boxes.leaves.size()) {
        Base::require_room(bytes_for<Tree>(boxes), *octree);
        const std::span<const Metric> metrics = octree->metrics();
        if constexpr (std::is_same_v<M, Metric>) {
            fill(tree_, boxes, [&](LeafIndex leaf) { return Value::of(metrics[leaf]); });
        } else {
            stored_.emplace(metrics);
            fill(tree_, boxes, [&](LeafIndex leaf) { return Value::of(stored_->items()[leaf]); });
            stored_->drop_items();
        }
    }

    void sample(std::span<const Point> x, std::span<Metric> out) const override { answer(x, out); }
    void sample_lengths(std::span<const Point> x, std::span<double> out) const override {
        if constexpr (are_lengths) {
            answer(x, out);
        } else {
            ControlSpace::sample_lengths(x, out);
        }
    }
    Metric metric_at(const Point& x) const override { return value_in(Base::voxel_of()(x)); }
    double length_at(const Point& x) const override {
        if constexpr (are_lengths) {
            return length_of(value_in(Base::voxel_of()(x)));
        } else {
            return ControlSpace::length_at(x);
        }
    }
    std::unique_ptr<Cursor> cursor() const override {
        return std::make_unique<PlainCursor<VdbTiles>>(*this);
    }

    Footprint footprint() const override {
        Footprint footprint = Base::footprint_of(tree_);
        footprint.cells = footprint.control_nodes = control_nodes_;  // leaves, as cell_at answers
        add_dense_bytes(tree_, footprint);
        if (stored_) footprint.bytes_payload += stored_->bytes();
        return footprint;
    }
    std::string vdb_file(StateWriter state) const override {
        const Octants octants = Base::cuts().octants(this->domain());
        const std::vector<Metric> all = metrics(octants);
        if (!std::ranges::all_of(all, is_isotropic)) {
            refuse("tensors are not saved to a .vdb: name a .ctrl");
        }
        return tiles_file(std::move(state), octants, lengths_in_floats(all));
    }

private:
    ControlNodes nodes_of(const Octants& octants, Neighbourhood neighbourhood) const override {
        return {leaf_graph(octants, neighbourhood).graph, metrics(octants)};
    }
    void save_field(const Octants& octants, StateWriter& state) const override {
        NodeMetrics::exchange(saved_metrics<M>(metrics(octants)), state);
    }

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
                Base::voxel_of().locate(places, batch);
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

    VdbStored<M> stored_;  // how codes are packed, without items
    Tree tree_{typename Value::Type(0)};
    std::size_t control_nodes_;
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
