// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <vector>

#include "controlspace/space/control_space.h"

namespace controlspace {

// Size fields in the formats of meshers that take one length per point: the smallest in any
// direction.

/// Summary of a file that was written.
struct SizeFile {
    std::size_t count;         ///< nodes of a grid or mesh, or points
    bool has_tensors = false;  ///< in the field, whose directions are lost
    /// Largest factor between the lengths that the mesher interpolates and those of the field, at
    /// 99 % of 1000 random places. None where it does not interpolate.
    std::optional<double> within = std::nullopt;
};

/// Throws InputError for a number of samples out of range.
void require_grid_samples(int samples);

/// The grid of Gmsh's field Structured, binary (TextFormat = 0): 2 to 512 nodes along the longest
/// edge of the domain, and nearly the same spacing along the others. Gmsh is trilinear
/// between them, and constant beyond with SetOutsideValue = 0, which 4.8.4 does not set by itself.
/// Throws InputError for a number of samples out of range, or if writing fails; no part of a file
/// is left. So do all others here.
SizeFile write_gmsh_structured(const std::filesystem::path& path, const ControlSpace& space,
                               int samples);

/// The same as an EUCLIDEAN-GRID of JIGSAW, for its hfun_file, with hfun_scal = absolute. JIGSAW
/// keeps lengths in single precision.
SizeFile write_jigsaw_grid(const std::filesystem::path& path, const ControlSpace& space,
                           int samples);

/// The background mesh of TetGen (its option -m): BASE.node, BASE.ele and BASE.mtr, where BASE is
/// NAME.b for the input NAME. Tetrahedra as small as the cells of the structure, and smaller where
/// its lengths are not linear within 2 %, by one halving, or 5 %, by two, up to 2 million nodes.
/// TetGen is linear in each. Throws InputError for a field without cells.
SizeFile write_tetgen_background(const std::filesystem::path& base, const ControlSpace& space);

/// The points of TetGen's input, a .node, .poly or .smesh; none where a .poly leaves them to its
/// .node. Throws InputError that names the line.
std::vector<Point> read_tetgen_points(const std::filesystem::path& path);

/// The local mesh sizes of Netgen (.msz, its option meshsizefilename): points at half the lengths
/// that they request, the smallest first. Netgen takes them as upper bounds, grows from there by
/// its own grading, and keeps lengths that are up to 20 % too large. Throws InputError for a field
/// without cells, or that requests more than 20 million points.
SizeFile write_netgen_sizes(const std::filesystem::path& path, const ControlSpace& space);

}  // namespace controlspace
