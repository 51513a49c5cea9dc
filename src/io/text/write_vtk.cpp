#include "controlspace/io/write_vtk.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>
#include <vector>

#include "controlspace/error.h"
#include "controlspace/geometry/subdivision.h"
#include "controlspace/space/control_nodes.h"
#include "controlspace/space/sample_parallel.h"
#include "geometry/point_order.h"
#include "io/text/cells.h"
#include "io/text/vtk_xml.h"

namespace controlspace {
namespace {

void write_points(const std::filesystem::path& path, std::span<const Point> positions,
                  std::span<const Metric> metrics) {
    VtkCells vertices;
    vertices.points.resize(positions.size());
    std::iota(vertices.points.begin(), vertices.points.end(), 0);
    write_vtk_grid(path, positions, vertices, metric_arrays(metrics), {});
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
    const std::vector<Box> leaves = elements_of(space);
    const std::vector<Point> corners = corners_of(leaves);
    VtkCells cells{VtkCells::hexahedron, 8, {}};
    std::vector<Point> centres;
    for (const Box& box : leaves) {
        centres.push_back(box.centre());
        for (const int i : hexahedron_corners) {
            const auto place =
                std::lower_bound(corners.begin(), corners.end(), corner(box, i), precedes);
            cells.points.push_back(place - corners.begin());
        }
    }
    std::vector<Metric> metrics(centres.size());
    space.sample(centres, metrics);
    write_vtk_grid(path, corners, cells, {}, metric_arrays(metrics));
}

void write_nodes(const std::filesystem::path& path, const ControlSpace& space) {
    const auto nodes = control_nodes(space, Neighbourhood::faces);
    if (!nodes) throw InputError("this field has no control nodes: write a slice of it");
    write_points(path, positions(nodes->graph), nodes->metrics);
}

void write_octree(const std::filesystem::path& path, const ControlSpace& space) {
    std::vector<Box> boxes{space.domain()};  // breadth first
    std::vector<bool> is_split;
    std::vector<std::int64_t> level_counts;
    std::vector<Point> centres;
    while (is_split.size() < boxes.size()) {
        const std::size_t level_end = boxes.size();
        level_counts.push_back(static_cast<std::int64_t>(level_end - is_split.size()));
        for (std::size_t i = is_split.size(); i < level_end; ++i) {
            const Box box = boxes[i];
            centres.push_back(box.centre());
            const Box leaf = space.cell_at(box.centre()).value_or(Box());
            is_split.push_back(!(leaf == box));
            if (leaf == box) continue;
            const Subdivision subdivision = octants(box);
            const bool is_inside = box.contains(leaf.low) && box.contains(leaf.high);
            if (!is_inside || !subdivision.is_proper()) {
                throw InputError(
                    "only an octree can be written as .htg: choose one, or name a .vtu");
            }
            for (int c = 0; c < 8; ++c) boxes.push_back(subdivision.child(c));
        }
    }
    std::vector<Metric> metrics(centres.size());
    space.sample(centres, metrics);
    write_vtk_octree(path, space.domain(), is_split, std::move(level_counts),
                     metric_arrays(metrics));
}

void write_slice(const std::filesystem::path& path, const ControlSpace& field, const Box& domain,
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
    Point origin = domain.low;
    origin[slice.axis] = slice.at;
    std::array<int, 3> counts{1, 1, 1};
    Vector spacing = Vector::Ones();
    for (Axis a = 0; a < 3; ++a) {
        if (a == slice.axis) continue;
        const double steps =
            std::max(1.0, std::round(edges[a] / edges.maxCoeff() * (slice.samples - 1)));
        counts[static_cast<std::size_t>(a)] = static_cast<int>(steps) + 1;
        spacing[a] = edges[a] / steps;
    }
    std::vector<Point> places;
    for (int k = 0; k < counts[2]; ++k) {
        for (int j = 0; j < counts[1]; ++j) {
            for (int i = 0; i < counts[0]; ++i) {
                places.push_back(origin + spacing.cwiseProduct(Vector(i, j, k)));
            }
        }
    }
    std::vector<Metric> metrics(places.size());
    sample_parallel(field, places, metrics);
    write_vtk_image(path, origin, spacing, counts, metric_arrays(metrics));
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
