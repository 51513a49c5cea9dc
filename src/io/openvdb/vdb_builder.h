// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <openvdb/Grid.h>

#include <array>
#include <cstddef>
#include <memory>
#include <span>

#include "controlspace/io/metric_grids.h"
#include "controlspace/sources/point_source.h"
#include "io/openvdb/sampled_block.h"

namespace controlspace {

/// One grid under construction. Blocks may be added by several threads and in any order.
class VdbBuilder {
public:
    virtual ~VdbBuilder() = default;

    /// Adds a block as a leaf, or as a tile if all of its voxels are the same. `inside` of them
    /// along each axis belong to the grid; `frames` holds the eigen_frame of each voxel that others
    /// refer to (SampledBlock::same_as). Returns the bytes of the leaf.
    virtual std::size_t add(const std::array<std::int32_t, 3>& first,
                            const std::array<std::int32_t, 3>& inside, const SampledBlock& block,
                            const std::array<EigenFrame, SampledBlock::size>& frames) = 0;

    /// Voxels that are kept one by one, rather than in tiles.
    virtual std::size_t voxels() const = 0;
    /// The grid, with its name and what Houdini needs; without transform.
    virtual openvdb::GridBase::Ptr finish() = 0;
};

std::unique_ptr<VdbBuilder> make_vdb_builder(const MetricGrid& grid);

/// The sources as a grid of points: positions, pscale (smallest length), metric_diag, metric_off.
openvdb::GridBase::Ptr make_points_grid(std::span<const PointSource> sources,
                                        const openvdb::math::Transform& transform);

}  // namespace controlspace
