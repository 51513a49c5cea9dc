// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "baselines/lattice/stencil.h"
#include "trees/topology/topology.h"

namespace controlspace {

// An octree as voxels of its finest leaves, whatever holds them.

using Octants = Topology<OctreeNode>;

/// A leaf of the octree as a box of such voxels.
struct VoxelBox {
    LeafIndex leaf = 0;
    Cell low, edges;
};

/// All leaves, in depth-first order, and the voxels along each axis.
struct VoxelBoxes {
    std::vector<VoxelBox> leaves;
    Cell voxels;

    explicit VoxelBoxes(const Octants& tree);

private:
    void visit(const Octants& tree, Ref ref, const VoxelBox& box);
};

/// Which parts of an octree are cut, depth first: enough to make it again. Of octrees that consist
/// of bricks, parts of `brick_levels` levels in which all leaves are of one size, it need not keep
/// what is below these.
class Cuts {
public:
    explicit Cuts(const Octants& tree, int brick_levels = 0);
    /// The octree, its leaves numbered depth first.
    Octants octants(const Box& domain) const { return octants(domain, brick_levels_); }
    /// The same with the bricks as leaves.
    Octants bricks(const Box& domain) const { return octants(domain, 0); }
    /// The leaf that holds a place in the domain.
    Box leaf_at(const Point& x, const Box& domain) const;
    std::size_t bytes() const {
        return cuts_.capacity() / 8 + children_.capacity() * sizeof(children_[0]) +
               large_.capacity() * sizeof(large_[0]);
    }

private:
    Octants octants(const Box& domain, int brick_levels) const;
    void note(const Octants& tree, std::span<const std::uint8_t> levels_below, Ref ref,
              std::size_t level);
    // Goes on behind the part that begins at `next`.
    void pass(std::size_t level, std::size_t& next) const;

    // A part that takes many bits, all within it counted.
    struct Large {
        std::uint32_t begin, end;
    };

    std::vector<bool> cuts_;
    std::vector<int> children_;  // of a part that is cut, by level
    std::vector<Large> large_;   // by their beginning: the others are passed bit by bit
    int brick_levels_;
};

/// The voxel that answers for a place: the one whose leaf the octree would find, on a face the low
/// one.
class VoxelOfPlace {
public:
    VoxelOfPlace(const Box& domain, const Cell& voxels);

    const Box& domain() const { return domain_; }
    /// Along each axis.
    const Cell& voxels() const { return voxels_; }
    /// How near to the face of a voxel rounding counts, along an axis, in voxels.
    double near(std::size_t axis) const { return near_[static_cast<Axis>(axis)]; }

    /// Where a place, or the nearest one in the domain, is along an axis, in voxels.
    [[gnu::always_inline]] double in_voxels(double x, std::size_t axis) const {
        const auto a = static_cast<Axis>(axis);
        const double above = x > domain_.low[a] ? x : domain_.low[a];
        const double place = above < domain_.high[a] ? above : domain_.high[a];
        return (place - domain_.low[a]) * per_length_[a];
    }
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
        for (std::size_t a = 0; a < 3; ++a) {
            const auto axis = static_cast<Axis>(a);
            const double low = domain_.low[axis], high = domain_.high[axis];
            const double per_length = per_length_[axis], near = near_[axis];
            // In vectors: a branch for each place would take longer than the rest.
            std::array<double, CellBatch::most> from_face;
            std::int64_t any = 0;
            for (std::size_t i = 0; i < x.size(); ++i) {
                const double above = x[i][axis] > low ? x[i][axis] : low;
                const double t = ((above < high ? above : high) - low) * per_length;
                const auto voxel = static_cast<std::int32_t>(t);
                const double beyond = t - voxel;
                batch.t[a][i] = t;
                batch.cell[a][i] = voxel;
                from_face[i] = beyond < 1 - beyond ? beyond : 1 - beyond;
            }
            for (std::size_t i = 0; i < x.size(); ++i) any |= from_face[i] <= near ? 1 : 0;
            for (std::size_t i = 0; any != 0 && i < x.size(); ++i) {
                if (is_near_face(batch.t[a][i], batch.cell[a][i], a)) {
                    batch.cell[a][i] = by_halving(x[i][axis], a);
                }
            }
        }
    }

private:
    // So near that rounding counts: the octree has halved its boxes, and rounded each middle.
    [[gnu::always_inline]] bool is_near_face(double t, std::int32_t voxel, std::size_t a) const {
        const double beyond = t - voxel, near = near_[static_cast<Axis>(a)];
        return (beyond <= near) | (beyond >= 1 - near);
    }
    std::int32_t by_halving(double x, std::size_t axis) const;

    Box domain_;
    Cell voxels_;
    Vector per_length_, near_;
};

}  // namespace controlspace
