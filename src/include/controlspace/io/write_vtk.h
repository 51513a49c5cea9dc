#pragma once

#include <filesystem>
#include <span>

#include "controlspace/metric/metric_field.h"
#include "controlspace/sources/point_source.h"
#include "controlspace/space/control_space.h"

namespace controlspace {

// Files for ParaView and whatever reads VTK's XML formats, with the arrays of add_metric_arrays.
// Each throws InputError if its file cannot be written, of which nothing is left then.

/// The elements of `space` as hexahedra (.vtu), with the metrics at their centres as data of cells.
void write_leaves(const std::filesystem::path& path, const ControlSpace& space);

/// The control nodes of `space` as vertices (.vtu), with their metrics as data of points.
void write_nodes(const std::filesystem::path& path, const ControlSpace& space);

/// An octree as vtkHyperTreeGrid (.htg): one tree of branch factor 2, with the metrics at the
/// centres of all its boxes as data of cells. Throws InputError for other structures too.
void write_octree(const std::filesystem::path& path, const ControlSpace& space);

/// A plane across the domain.
struct Slice {
    Axis axis = 2;      ///< that it is across
    double at = 0;      ///< coordinate along that axis
    int samples = 512;  ///< places along the longer edge of the domain
};

/// The field on a slice through `domain` as an image (.vti), with data of points; the places along
/// the shorter edge are as far apart as along the longer one, or nearly. Throws InputError for a
/// slice outside the domain, and unless there are from 2 to 8192 samples.
void write_slice(const std::filesystem::path& path, const MetricField& field, const Box& domain,
                 const Slice& slice);

/// `sources` as vertices with data of points, which read_vtk_sources reads again: .vtu or .vtp by
/// the name's ending.
void write_vtk_sources(const std::filesystem::path& path, std::span<const PointSource> sources);

}  // namespace controlspace
