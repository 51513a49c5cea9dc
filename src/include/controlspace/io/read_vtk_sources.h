// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "controlspace/fields/analytic_field.h"
#include "controlspace/io/read_sources.h"
#include "controlspace/sources/point_source.h"

namespace controlspace {

/// Sources at the points of a VTK file (.vtu, .vtp, .vti or the legacy .vtk) that carry the array
/// `options.array`, or, where no array of points has that name, at the centres (means of the
/// points) of cells that do; without a name, the only one whose name contains ":metric". It holds
/// sizes h (1 component) or Riemannian metrics M^-2: 6 components in VTK's order XX YY ZZ XY YZ XZ,
/// or 9 by rows. Exported leaves, control nodes and slices are read again so, as sources. Of
/// several steps in time `options` name one. Points and cells that VTK marks as hidden
/// (vtkGhostType) are left out, with a remark; a field that has such is refused.
///
/// Throws InputError that names the file for what VTK cannot read; for more points or cells than
/// the file has room for; for an array that is missing, or of another number of components; and for
/// points and metrics that cannot be sources, by their number.
///
/// VTK does not validate files: a damaged one may crash it or exhaust memory. For files of
/// unknown origin call require_readable first (controlspace/io/require_readable.h).
std::vector<PointSource> read_vtk_sources(const std::filesystem::path& path,
                                          const ReadOptions& options = {});

/// A finished field: in each cell of a .vtu or .vti (all with a volume) its own metric, or, of
/// arrays of points, the metrics M blended by the cell's shape functions, which is linear between
/// its corners; where those of higher order undershoot all metrics of the file, by their positive
/// ones. It is defined in the box of the cells; where that has no cell, and outside, the nearest
/// place of a cell answers.
/// Throws InputError as above, and for cells without a volume.
AnalyticField read_vtk_field(const std::filesystem::path& path, const std::string& array = {});

}  // namespace controlspace
