#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "controlspace/sources/point_source.h"
#include "controlspace/space/control_space.h"

namespace controlspace {

/// Sources out of a list view of Gmsh (`.pos`): View "name" { SP(x,y,z){h}; ... }; with a value at
/// each corner of points, lines, triangles, quadrangles, tetrahedra, hexahedra, prisms and pyramids
/// (second letter P L T Q S H I Y). Scalars (S) are sizes h; tensors (T), nine numbers by rows, are
/// Riemannian metrics M^-2. Corners that elements share, with the same value, make one source.
///
/// `view` names the view; empty: the only one. Throws InputError "name:line: what is wrong", or
/// naming the tensor that is not positive definite.
std::vector<PointSource> read_pos_sources(const std::filesystem::path& path,
                                          const std::string& view = {});

/// The same for a text at hand; `path` is for messages.
std::vector<PointSource> parse_pos_sources(std::string_view text, const std::filesystem::path& path,
                                           const std::string& view = {});

/// Writes `sources` as such a view: points with sizes where all are isotropic, with tensors
/// otherwise. Throws InputError if that fails; no part of a file is left.
void write_pos_sources(const std::filesystem::path& path, std::span<const PointSource> sources);

/// What a view of cells consists of.
struct PosCells {
    std::size_t count;
    bool has_tensors;
};

/// Writes a field as such a view: a hexahedron for each cell of the structure, with the values at
/// its corners, so that Gmsh answers inside of it as the structure does. Isotropic cells whose
/// lengths are not trilinear within 1 % are halved up to twice: Gmsh is then within 1 % of the
/// structure at 99 % of places, of quadratic leaves at 96 %. Throws InputError for a field
/// without cells, or if writing fails; no part of a file is left.
PosCells write_pos_cells(const std::filesystem::path& path, const ControlSpace& space);

}  // namespace controlspace
