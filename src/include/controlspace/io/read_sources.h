#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "controlspace/sources/point_source.h"

namespace controlspace {

/// Sources from a file, by its extension:
///   - `.csv`: a line of names, x, y, z and either h, or m_xx, m_yy, m_zz, m_xy, m_xz, m_yz (the
///     tensor of lengths M), or h1, h2, h3, e1x, e1y, e1z, e2x, e2y, e2z (lengths along two
///     orthogonal directions and across them);
///   - `.mesh`, `.meshb`, `.sol` or `.solb`: a Medit mesh or solution that has the other beside it
///     under the same name, with lengths, or Riemannian metrics M^-2 as xx xy yy xz yz zz;
///   - `.pos`: a list view of Gmsh, with lengths, or Riemannian metrics.
/// A pipe without an extension is read as CSV. Throws InputError, naming file and line or offset,
/// for anything that cannot be read as such.
std::vector<PointSource> read_sources(const std::filesystem::path& path);

/// The ending of a file's name, which tells its format, in small letters: ".csv".
std::string lower_case_extension(const std::filesystem::path& path);

}  // namespace controlspace
