// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "controlspace/sources/point_source.h"

namespace controlspace {

/// Which data of a file are read, and where remarks on them go.
struct ReadOptions {
    std::string array = {};  ///< name of the array or view; empty: the only one
    /// Of a view with several steps in time the number that the file gives a step, or its place
    /// from 0 where the file numbers none; none: the last.
    std::optional<std::uint64_t> step = {};
    /// Receives what was chosen or left out without having been requested, one line each.
    std::function<void(const std::string&)> remark = {};
};

/// Sources from a file, by its extension:
///   - `.csv`: a line of names, x, y, z and either h, or m_xx, m_yy, m_zz, m_xy, m_xz, m_yz (the
///     tensor M, whose eigenvalues are lengths), or h1, h2, h3, e1x, e1y, e1z, e2x, e2y, e2z
///     (lengths along two orthogonal directions and normal to both); and g, if there is such a
///     column, the gradation ratio of the source's own;
///   - `.npy`: an array of NumPy of doubles or floats with rows x, y, z, h or x, y, z, h, g;
///   - `.mesh`, `.meshb`, `.sol` or `.solb`: a Medit mesh or solution that has the other beside it
///     under the same name, of the plane or space, with lengths, or Riemannian metrics M^-2 as xx
///     xy yy xz yz zz; a mesh without a solution gives the lengths of its required edges, at their
///     ends;
///   - `.pos` and `.msh`: a list view of Gmsh, or a mesh (formats 4.1 and 2.x) with $NodeData, with
///     $ElementData for the centres of elements or $ElementNodeData for their corners, with
///     lengths, or Riemannian metrics M^-2 by rows; `array` names the view, if there is more than
///     one.
/// Lengths are in the units of the positions. A pipe without an extension is read as CSV. Throws
/// InputError, naming file and line or offset, for anything that cannot be read as such, and
/// naming the first tensor that is not positive definite.
std::vector<PointSource> read_sources(const std::filesystem::path& path,
                                      const ReadOptions& options = {});

/// The position of the source of that index (from 0) in its file, for messages: "line 19" of a
/// .csv, "number 18" of others and of pipes.
std::string place_of_source(const std::filesystem::path& path, std::size_t index);

/// Writes `sources` in the format given by the file's extension: .csv, .pos, .vtu, .vtp, or .mesh,
/// .sol, .meshb or .solb, which makes a mesh and a solution. read_sources, and read_vtk_sources for
/// .vtu and .vtp, read them again: the same to the last bit from .csv and where all are isotropic.
/// Throws InputError for another ending, and if writing fails, of which nothing is left.
void write_sources(const std::filesystem::path& path, std::span<const PointSource> sources);

/// The extension of a file name in lower case, which selects its format: ".csv".
std::string lower_case_extension(const std::filesystem::path& path);

}  // namespace controlspace
