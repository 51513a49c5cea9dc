// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <span>

#include "controlspace/sources/point_source.h"
#include "controlspace/space/control_space.h"

namespace controlspace {

// Files for ParaView and other programs that read VTK's XML formats, written without VTK, with the
// arrays `controlspace:metric`, the Riemannian metric M^-2 as a matrix by rows (9 components), and
// `h_min`, `h_max`, `h_mean` and `anisotropy`: smallest, largest and mean length in the units of
// the domain, and the ratio of the first two. Each function throws InputError if its file cannot
// be written, and leaves no part of it.

/// The leaves or cells of `space` as hexahedra (.vtu), with the metrics at their centres as data of
/// cells.
void write_leaves(const std::filesystem::path& path, const ControlSpace& space);
/// The same of those in `regions`, unions of cells: a piece of a .pvtu.
void write_leaves(const std::filesystem::path& path, const ControlSpace& space,
                  std::span<const Box> regions);

/// What holds pieces together (.pvtu) that write_leaves has written, beside it.
void write_leaf_pieces(const std::filesystem::path& path,
                       std::span<const std::filesystem::path> pieces);

/// The control nodes of `space` as vertices (.vtu), with their metrics as data of points.
void write_nodes(const std::filesystem::path& path, const ControlSpace& space);

/// An octree as vtkHyperTreeGrid (.htg): a tree of branch factor 2, or several side by side where
/// the domain is oblong, with the metrics at the centres of all its boxes as data of cells. Throws
/// InputError for other structures, and where it takes more than 65536 trees.
void write_octree(const std::filesystem::path& path, const ControlSpace& space);

/// A plane across the domain.
struct Slice {
    Axis axis = 2;      ///< normal to the plane
    double at = 0;      ///< coordinate along that axis
    int samples = 512;  ///< points along the longer edge of the domain
};

/// Throws InputError unless there are from 2 to 8192 samples.
void require_slice_samples(int samples);

/// The field on a slice through `domain` as an image (.vti), with data of points; points along the
/// shorter edge have the same distance as along the longer one, or nearly. Throws InputError for a
/// slice outside the domain, and as require_slice_samples.
void write_slice(const std::filesystem::path& path, const ControlSpace& field, const Box& domain,
                 const Slice& slice);

/// `sources` as vertices with data of points, which read_vtk_sources reads again: .vtu or .vtp by
/// the name's ending.
void write_vtk_sources(const std::filesystem::path& path, std::span<const PointSource> sources);

}  // namespace controlspace
