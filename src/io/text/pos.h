// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <span>
#include <string_view>
#include <vector>

#include "controlspace/io/read_sources.h"
#include "controlspace/sources/point_source.h"
#include "controlspace/space/control_space.h"

namespace controlspace {

/// Sources out of a list view of Gmsh (`.pos`): View "name" { SP(x,y,z){h}; ... }; with a value at
/// each corner of points, lines, triangles, quadrangles, tetrahedra, hexahedra, prisms and pyramids
/// (second letter P L T Q S H I Y). Scalars (S) are sizes h; tensors (T), nine numbers by rows, are
/// Riemannian metrics M^-2. Corners that elements share, with the same value, make one source.
///
/// `options` name the view and its step in time (from 0; TIME{...} is passed over). Throws
/// InputError "name:line: what is wrong", or naming the tensor that is not positive definite.
std::vector<PointSource> read_pos_sources(const std::filesystem::path& path,
                                          const ReadOptions& options = {});

/// The same from `text`; `path` is used in messages.
std::vector<PointSource> parse_pos_sources(std::string_view text, const std::filesystem::path& path,
                                           const ReadOptions& options = {});

/// Writes `sources` as such a view: points with sizes where all are isotropic, with tensors
/// otherwise. Throws InputError if that fails; no part of a file is left.
void write_pos_sources(const std::filesystem::path& path, std::span<const PointSource> sources);

/// Summary of a view of cells.
struct PosCells {
    std::size_t count;
    bool has_tensors;
    /// The share of the domain's volume, and of the elements that it requests, together, where
    /// lengths that are interpolated in the cells differ from the structure's by more than 1 %.
    double off;
};

/// Writes a field as such a view: a hexahedron for each cell of the structure, with the values at
/// its corners, so that Gmsh interpolates in it as the structure does. Cells where it does not
/// are halved until `off` is at most 0.01; a view that gets 1 000 000 cells by that, or 200 000
/// with tensors, remains further off. Throws InputError for a field without cells, or if writing
/// fails; no part of a file is left.
PosCells write_pos_cells(const std::filesystem::path& path, const ControlSpace& space);

}  // namespace controlspace
