#pragma once

#include <vtkFieldData.h>
#include <vtkXMLWriter.h>

#include <filesystem>
#include <span>

#include "controlspace/metric/metric.h"

namespace controlspace {

/// Name of the array that holds metrics in files that this project writes: programs that read
/// metrics from VTK files (MMG) look for ":metric".
inline constexpr const char* vtk_metric_array = "controlspace:metric";

/// Adds what is shown of `metrics` to the data of points or cells, in their order: the Riemannian
/// metric M^-2 by rows, 9 components; h_min, h_max and h_mean, its smallest, largest and mean
/// length; and anisotropy, the ratio of the first two.
void add_metric_arrays(vtkFieldData& data, std::span<const Metric> metrics);

/// Writes `data` by `writer`, compressed. Throws InputError if that fails; no part of a file is
/// left.
void write_vtk_file(vtkXMLWriter& writer, vtkDataObject& data, const std::filesystem::path& path);

}  // namespace controlspace
