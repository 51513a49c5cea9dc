// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "controlspace/geometry/box.h"
#include "controlspace/metric/metric.h"

namespace controlspace {

// Files of VTK's XML formats, written without VTK: XML with the numbers as raw binary data behind
// it. Each writer throws InputError if that fails; no part of a file is left.

/// Name of the array that holds metrics: programs that read metrics from VTK files (MMG) look for
/// ":metric".
inline constexpr const char* vtk_metric_array = "controlspace:metric";

/// Data of points or cells.
struct VtkArray {
    std::string name;
    int components = 1;
    std::vector<double> values;
};

/// The arrays that are written for `metrics`: vtk_metric_array, the Riemannian metric M^-2 by
/// rows, 9 components; h_min, h_max and h_mean, the smallest, largest and mean length; and
/// anisotropy, the ratio of the largest to the smallest.
std::vector<VtkArray> metric_arrays(std::span<const Metric> metrics);

/// Cells of one kind.
struct VtkCells {
    static constexpr std::uint8_t vertex = 1, quad = 9, tetrahedron = 10, hexahedron = 12;

    std::uint8_t type = vertex;
    std::size_t corners = 1;
    std::vector<std::int64_t> points;  ///< of one cell after the other
};

/// A grid of cells: .vtu, or .vtp (vertices only) by the ending of the name.
void write_vtk_grid(const std::filesystem::path& path, std::span<const Point> points,
                    const VtkCells& cells, std::span<const VtkArray> point_data,
                    std::span<const VtkArray> cell_data);

/// The .vtu files `pieces`, beside it, as one grid: .pvtu. Their cells have the arrays `cell_data`,
/// of which names and numbers of components are written.
void write_vtk_pieces(const std::filesystem::path& path,
                      std::span<const std::filesystem::path> pieces,
                      std::span<const VtkArray> cell_data);

/// An image of counts[0] x counts[1] x counts[2] points, x fastest: .vti.
void write_vtk_image(const std::filesystem::path& path, const Point& origin, const Vector& spacing,
                     const std::array<int, 3>& counts, std::span<const VtkArray> point_data);

/// The parts of a file before and after the `bytes` of the only array of such an image, of doubles,
/// which the caller writes in between: for images that are larger than memory.
std::pair<std::string, std::string> vtk_image_frame(const Point& origin, const Vector& spacing,
                                                    const std::array<int, 3>& counts,
                                                    std::string_view array, std::uint64_t bytes);

/// A tree of branch factor 2, breadth first, x fastest among siblings: which boxes have children,
/// how many boxes each level has, and the data of all boxes.
struct VtkTree {
    std::vector<bool> is_split;
    std::vector<std::int64_t> level_counts;
    std::vector<VtkArray> cell_data;
};

/// A grid of such trees over `domain`, so many along each axis, x fastest; quadtrees where the
/// domain is flat: vtkHyperTreeGrid (.htg).
void write_vtk_octrees(const std::filesystem::path& path, const Box& domain,
                       const std::array<int, 3>& counts, std::span<const VtkTree> trees);

}  // namespace controlspace
