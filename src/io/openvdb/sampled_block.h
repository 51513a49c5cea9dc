// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "controlspace/geometry/box.h"
#include "controlspace/metric/metric.h"
#include "controlspace/space/control_space.h"

namespace controlspace {

/// Cubic voxels that cover a box from its low corner on, a flat one in a single layer. The last
/// ones may extend beyond it: their centres are moved to the nearest point of the box.
struct VoxelLattice {
    Box domain;
    double voxel = 0;                      ///< edge
    std::array<std::int32_t, 3> counts{};  ///< voxels along x, y, z

    Point centre(std::int32_t i, std::int32_t j, std::int32_t k) const {
        const Point x = domain.low + voxel * Vector(i + 0.5, j + 0.5, k + 0.5);
        return x.cwiseMin(domain.high);
    }
    double size() const {
        return static_cast<double>(counts[0]) * static_cast<double>(counts[1]) *
               static_cast<double>(counts[2]);
    }
};

/// Voxels of edge `voxel`, or of 1/128 of the longest edge of `domain` if that is 0. Throws
/// InputError if it is negative, not finite, or gives more than 2^32 of them.
VoxelLattice voxel_lattice(const Box& domain, double voxel);

/// The metrics of 8^3 voxels, a leaf of a VDB tree: x slowest, z fastest.
struct SampledBlock {
    static constexpr std::int32_t side = 8;
    static constexpr std::size_t size = 512;

    std::array<Metric, size> metrics;
    /// For each voxel the first one of the cube whose metric it shares; itself if it shares none.
    std::array<std::uint16_t, size> same_as;

    static std::size_t index(std::int32_t i, std::int32_t j, std::int32_t k) {
        return static_cast<std::size_t>(i * side + j) * static_cast<std::size_t>(side) +
               static_cast<std::size_t>(k);
    }
};

/// Samples `field` at the centres of the block of voxels from `first` on (multiples of 8; voxels
/// beyond the lattice repeat the last one within). Then cubes of 8^3, 4^3 and 2^3 voxels whose
/// lengths all differ by a factor of at most 1 + tolerance, in any direction, from those of their
/// mean take the mean; cubes that hold one metric keep it. Throws InputError where the field
/// answers something that is no metric.
void sample_block(const ControlSpace& field, const VoxelLattice& lattice,
                  const std::array<std::int32_t, 3>& first, double tolerance, SampledBlock& block);

}  // namespace controlspace
