#pragma once

#include <openvdb/Grid.h>

#include <array>
#include <cstddef>
#include <memory>

#include "controlspace/io/metric_grids.h"
#include "io/openvdb/sampled_block.h"

namespace controlspace {

/// One grid of a file in the making. Blocks come in layers: those of one layer may be filled at the
/// same time, each into its own slot.
class VdbBuilder {
public:
    virtual ~VdbBuilder() = default;

    /// Makes room for the blocks of a layer.
    virtual void start_layer(std::size_t blocks) = 0;
    /// `inside` of the block's voxels along each axis belong to the grid; `frames` holds the
    /// eigen_frame of each voxel that others refer to (SampledBlock::same_as).
    virtual void fill(std::size_t slot, const std::array<std::int32_t, 3>& first,
                      const std::array<std::int32_t, 3>& inside, const SampledBlock& block,
                      const std::array<EigenFrame, SampledBlock::size>& frames) = 0;
    /// Puts the layer's blocks into the tree.
    virtual void finish_layer() = 0;

    /// Bytes that the grid takes.
    virtual std::size_t bytes() const = 0;
    /// Voxels that are kept one by one, rather than in tiles.
    virtual std::size_t voxels() const = 0;
    /// The grid, with its name and what Houdini asks for; without transform.
    virtual openvdb::GridBase::Ptr finish() = 0;
};

std::unique_ptr<VdbBuilder> make_vdb_builder(const MetricGrid& grid);

}  // namespace controlspace
