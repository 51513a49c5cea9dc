#pragma once

#include <openvdb/Types.h>

#include "baselines/lattice/stencil.h"
#include "controlspace/space/space_options.h"

namespace controlspace {

/// Lattices of cells over a box, one a level: level 0 is the finest, each further one has cells of
/// twice the edges, the coarsest (top) a few along each axis. Cell c of level l consists of the
/// cells 2c + {0, 1}^3 of level l - 1. Index space starts at 0. Points are located in the finest.
/// Across a flat domain all levels have one cell, and its corners are on one layer of nodes.
class LevelCells : public CellsOfBox {
public:
    using Coord = openvdb::Coord;

    LevelCells(const Box& domain, const Vector& coarsest_cells, int levels);

    int levels() const { return levels_; }
    int top() const { return levels_ - 1; }
    /// Number of cells along x, y and z.
    Coord cells_of(int level) const;
    /// Corner `i` of a cell, or its part `i`, relative to the low one; see has_part.
    Coord step(std::size_t i) const {
        const auto along = [&](std::size_t a) {
            return static_cast<openvdb::Int32>(step_to(i, a));
        };
        return {along(0), along(1), along(2)};
    }
    /// Whether number `i` of eight corners or parts is one of its own; in a flat domain half of
    /// them coincide with others.
    bool has_part(std::size_t i) const {
        return step_to(i, 0) + 2 * step_to(i, 1) + 4 * step_to(i, 2) == i;
    }
    /// `n` places along each axis, one across a flat domain.
    Coord places(int n) const {
        const Coord high = step(7);
        return {1 + high.x() * (n - 1), 1 + high.y() * (n - 1), 1 + high.z() * (n - 1)};
    }
    /// Edges of a cell.
    Vector edges(int level) const { return spacing_ * static_cast<double>(1 << level); }
    Point vertex(int level, const Coord& c) const;
    Point centre(int level, const Coord& c) const { return vertex(level, c) + 0.5 * edges(level); }
    /// The cell, in which `x` was found: as CellsOfBox::cell_at.
    Box box(int level, const Coord& c, const Point& x) const;
    bool contains(int level, const Coord& c) const;

private:
    int levels_;
    Vector spacing_;  // edges of the finest cells
};

/// Levels whose finest cells have edges of at most `voxel`, or of l_min and voxel_factor times the
/// finest length where that is 0; the coarsest are 8 to 15 along the longest edge, if there are so
/// many. Throws InputError where the options are invalid or request more than 2^29 cells along an
/// edge.
LevelCells choose_levels(const SpaceOptions& options);

}  // namespace controlspace
