#include "controlspace/io/write_vtk.h"

#include <fmt/format.h>
#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkCellType.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkUnstructuredGrid.h>
#include <vtkXMLImageDataWriter.h>
#include <vtkXMLPolyDataWriter.h>
#include <vtkXMLUnstructuredGridWriter.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "controlspace/error.h"
#include "controlspace/io/read_sources.h"
#include "controlspace/space/control_nodes.h"
#include "geometry/point_order.h"
#include "io/vtk/elements.h"
#include "io/vtk/vtk_fields.h"

namespace controlspace {
namespace {

vtkIdType id(std::size_t i) { return static_cast<vtkIdType>(i); }

vtkNew<vtkPoints> points_of(std::span<const Point> positions) {
    vtkNew<vtkPoints> points;
    points->SetDataTypeToDouble();
    points->SetNumberOfPoints(id(positions.size()));
    for (std::size_t i = 0; i < positions.size(); ++i) {
        points->SetPoint(id(i), positions[i].data());
    }
    return points;
}

vtkNew<vtkCellArray> vertices(std::size_t count) {
    vtkNew<vtkCellArray> cells;
    for (vtkIdType i = 0; i < id(count); ++i) cells->InsertNextCell(1, &i);
    return cells;
}

void write_points(const std::filesystem::path& path, std::span<const Point> positions,
                  std::span<const Metric> metrics) {
    const auto fill = [&](auto& grid) {
        grid.SetPoints(points_of(positions));
        add_metric_arrays(*grid.GetPointData(), metrics);
    };
    if (lower_case_extension(path) == ".vtp") {
        vtkNew<vtkPolyData> grid;
        fill(*grid);
        grid->SetVerts(vertices(positions.size()));
        return write_vtk_file(*vtkNew<vtkXMLPolyDataWriter>(), *grid, path);
    }
    vtkNew<vtkUnstructuredGrid> grid;
    fill(*grid);
    grid->SetCells(VTK_VERTEX, vertices(positions.size()));
    write_vtk_file(*vtkNew<vtkXMLUnstructuredGridWriter>(), *grid, path);
}

/// Corners of all boxes, each once.
std::vector<Point> corners_of(std::span<const Box> boxes) {
    std::vector<Point> corners;
    for (const Box& box : boxes) {
        for (int i = 0; i < 8; ++i) corners.push_back(corner(box, i));
    }
    std::sort(corners.begin(), corners.end(), precedes);
    corners.erase(std::unique(corners.begin(), corners.end()), corners.end());
    return corners;
}

}  // namespace

void write_leaves(const std::filesystem::path& path, const ControlSpace& space) {
    const std::vector<Box> boxes = elements_of(space);
    const std::vector<Point> corners = corners_of(boxes);
    std::vector<Point> centres;
    vtkNew<vtkCellArray> cells;
    for (const Box& box : boxes) {
        centres.push_back(box.centre());
        // VTK goes around each face, where corners here are numbered by bits.
        constexpr int hexahedron[] = {0, 1, 3, 2, 4, 5, 7, 6};
        cells->InsertNextCell(8);
        for (const int i : hexahedron) {
            const auto place =
                std::lower_bound(corners.begin(), corners.end(), corner(box, i), precedes);
            cells->InsertCellPoint(place - corners.begin());
        }
    }
    std::vector<Metric> metrics(centres.size());
    space.sample(centres, metrics);
    vtkNew<vtkUnstructuredGrid> grid;
    grid->SetPoints(points_of(corners));
    grid->SetCells(VTK_HEXAHEDRON, cells);
    add_metric_arrays(*grid->GetCellData(), metrics);
    write_vtk_file(*vtkNew<vtkXMLUnstructuredGridWriter>(), *grid, path);
}

void write_nodes(const std::filesystem::path& path, const ControlSpace& space) {
    const auto nodes = control_nodes(space, Neighbourhood::faces);
    if (!nodes) throw InputError("this field has no control nodes: write a slice of it");
    write_points(path, positions(nodes->graph), nodes->metrics);
}

void write_slice(const std::filesystem::path& path, const MetricField& field, const Box& domain,
                 const Slice& slice) {
    if (slice.samples < 2 || slice.samples > 8192) {
        throw InputError(fmt::format("{} samples: give 2 to 8192", slice.samples));
    }
    if (!(slice.at >= domain.low[slice.axis] && slice.at <= domain.high[slice.axis])) {
        throw InputError(fmt::format("a slice at {} = {} is outside the domain {}",
                                     "xyz"[slice.axis], slice.at, to_string(domain)));
    }
    Vector edges = domain.edges();
    edges[slice.axis] = 0;
    const double longest = edges.maxCoeff();
    Point origin = domain.low;
    origin[slice.axis] = slice.at;
    std::array<int, 3> counts{};
    Vector spacing = Vector::Ones();
    for (Axis a = 0; a < 3; ++a) {
        if (a == slice.axis) {
            counts[static_cast<std::size_t>(a)] = 1;
            continue;
        }
        const double steps = std::max(1.0, std::round(edges[a] / longest * (slice.samples - 1)));
        counts[static_cast<std::size_t>(a)] = static_cast<int>(steps) + 1;
        spacing[a] = edges[a] / steps;
    }
    vtkNew<vtkImageData> image;
    image->SetOrigin(origin.data());
    image->SetSpacing(spacing.data());
    image->SetDimensions(counts.data());
    std::vector<Point> places(static_cast<std::size_t>(image->GetNumberOfPoints()));
    for (std::size_t i = 0; i < places.size(); ++i) image->GetPoint(id(i), places[i].data());
    std::vector<Metric> metrics(places.size());
    field.evaluate(places, metrics);
    add_metric_arrays(*image->GetPointData(), metrics);
    write_vtk_file(*vtkNew<vtkXMLImageDataWriter>(), *image, path);
}

void write_vtk_sources(const std::filesystem::path& path, std::span<const PointSource> sources) {
    std::vector<Point> positions;
    std::vector<Metric> metrics;
    for (const PointSource& s : sources) {
        positions.push_back(s.position);
        metrics.push_back(s.metric);
    }
    write_points(path, positions, metrics);
}

}  // namespace controlspace
