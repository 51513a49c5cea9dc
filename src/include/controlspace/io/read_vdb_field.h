#pragma once

#include <filesystem>

#include "controlspace/fields/analytic_field.h"
#include "controlspace/io/vdb_choice.h"

namespace controlspace {

/// Reads the metrics that write_vdb wrote, or lengths or densities of anybody's. Between the
/// voxels' centres the eight around a point are blended, linear in M; those that are not active do
/// not count. Where none of them is active the length is the coarsest of the file (of `density`).
/// The field is defined in the box of the active voxels; points outside are answered as its nearest
/// point.
///
/// Throws InputError that names the file for what cannot be read, grids that are missing (with a
/// list of what is there), of another type, empty, or under a transform that is not linear; and for
/// voxels that are not a number, not positive (lengths), or not positive definite.
///
/// OpenVDB trusts what a file says: a damaged one may crash it, or take all memory. Read files of
/// unknown origin in a process of their own first, as the program does.
AnalyticField read_vdb_field(const std::filesystem::path& path, const VdbLengths& what = {});

}  // namespace controlspace
