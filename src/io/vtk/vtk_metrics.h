// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vtkDataSet.h>
#include <vtkImageData.h>
#include <vtkSmartPointer.h>

#include <Eigen/Core>
#include <cstddef>
#include <filesystem>
#include <vector>

#include "controlspace/io/read_sources.h"

namespace controlspace {

/// The metrics at the points or centres of cells of a file of VTK.
struct VtkMetrics {
    vtkSmartPointer<vtkDataSet> grid;
    bool at_points;
    std::vector<Point> positions;
    std::vector<Metric> metrics;
    std::size_t hidden = 0;  ///< points or cells that are left out: ParaView does not show them
};

/// `option` names an array, for messages. Throws InputError for what is no such file.
VtkMetrics read_vtk_metrics(const std::filesystem::path& path, const ReadOptions& options,
                            const char* option);

/// Whether point or cell `i` is marked as none, for which VTK has bits in an array of the grid.
bool is_hidden(vtkDataSet& grid, bool at_points, vtkIdType i);

/// The axes of an image as columns.
Eigen::Matrix3d axes_of(vtkImageData& image);

}  // namespace controlspace
