// SPDX-License-Identifier: Apache-2.0
#include "io/openvdb/vdb_builder.h"

#include <openvdb/openvdb.h>
#include <openvdb/tools/Prune.h>

#include <algorithm>
#include <mutex>
#include <string>

namespace controlspace {
namespace {

using openvdb::Coord;

template <class Value>
Value value_from(const std::array<double, 3>& v) {
    if constexpr (std::is_same_v<Value, float>) {
        return static_cast<float>(v[0]);
    } else {
        return {static_cast<float>(v[0]), static_cast<float>(v[1]), static_cast<float>(v[2])};
    }
}

template <class Grid>
class Builder final : public VdbBuilder {
    using Tree = typename Grid::TreeType;
    using Leaf = typename Tree::LeafNodeType;
    using Value = typename Tree::ValueType;
    static_assert(Leaf::DIM == SampledBlock::side);

public:
    explicit Builder(const MetricGrid& kind)
        : kind_(kind), grid_(Grid::create(openvdb::zeroVal<Value>())) {}

    std::size_t add(const std::array<std::int32_t, 3>& first,
                    const std::array<std::int32_t, 3>& inside, const SampledBlock& block,
                    const std::array<EigenFrame, SampledBlock::size>& frames) override {
        std::array<Value, SampledBlock::size> values;
        for (std::size_t v = 0; v < values.size(); ++v) {
            const std::size_t same = block.same_as[v];
            values[v] = same == v ? value_from<Value>(kind_.value(block.metrics[v], frames[v]))
                                  : values[same];
        }
        const Coord origin(first[0], first[1], first[2]);
        const bool whole = std::all_of(inside.begin(), inside.end(),
                                       [](std::int32_t n) { return n == SampledBlock::side; });
        if (whole && std::all_of(values.begin(), values.end(),
                                 [&](const Value& value) { return value == values[0]; })) {
            constexpr openvdb::Index level_of_leaf_sized_tiles = 1;
            const std::lock_guard lock(mutex_);
            grid_->tree().addTile(level_of_leaf_sized_tiles, origin, values[0], true);
            return 0;
        }
        auto leaf = std::make_unique<Leaf>(origin, openvdb::zeroVal<Value>(), /*active=*/false);
        for (openvdb::Index v = 0; v < values.size(); ++v) {
            const Coord at = Leaf::offsetToLocalCoord(v);
            if (at.x() >= inside[0] || at.y() >= inside[1] || at.z() >= inside[2]) continue;
            leaf->setValueOn(v, values[v]);
        }
        const std::lock_guard lock(mutex_);
        voxels_ += leaf->onVoxelCount();
        grid_->tree().addLeaf(leaf.release());
        return sizeof(Leaf) + SampledBlock::size * sizeof(Value);
    }

    std::size_t voxels() const override { return voxels_; }

    openvdb::GridBase::Ptr finish() override {
        openvdb::tools::pruneTiles(grid_->tree());  // exact: equal tiles become one
        grid_->setName(std::string(kind_.name));
        grid_->setGridClass(kind_.kind == GridKind::fog ? openvdb::GRID_FOG_VOLUME
                                                        : openvdb::GRID_UNKNOWN);
        grid_->setVectorType(kind_.kind == GridKind::direction ? openvdb::VEC_CONTRAVARIANT_RELATIVE
                                                               : openvdb::VEC_INVARIANT);
        grid_->setIsInWorldSpace(true);
        grid_->insertMeta("description", openvdb::StringMetadata(std::string(kind_.help)));
        return grid_;
    }

private:
    MetricGrid kind_;
    typename Grid::Ptr grid_;
    std::mutex mutex_;
    std::size_t voxels_ = 0;
};

}  // namespace

std::unique_ptr<VdbBuilder> make_vdb_builder(const MetricGrid& grid) {
    const bool one_number = grid.kind == GridKind::fog || grid.kind == GridKind::number;
    if (one_number) return std::make_unique<Builder<openvdb::FloatGrid>>(grid);
    return std::make_unique<Builder<openvdb::Vec3SGrid>>(grid);
}

}  // namespace controlspace
