// SPDX-License-Identifier: Apache-2.0
#include "controlspace/io/write_vtk.h"

#include <algorithm>
#include <numeric>
#include <tuple>
#include <utility>
#include <vector>

#include "controlspace/geometry/subdivision.h"
#include "controlspace/io/write_lengths.h"
#include "controlspace/space/control_nodes.h"
#include "controlspace/space/sample_parallel.h"
#include "geometry/point_order.h"
#include "io/text/cells.h"
#include "io/text/vtk_xml.h"
#include "refuse.h"

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

/// The root boxes of the octrees that together are one whose first levels do not cut all axes, x
/// fastest; and how many there are along each axis.
std::vector<Box> octree_roots(const Box& domain, std::array<int, 3>& counts) {
    constexpr std::size_t most = 1 << 16;
    std::vector<Box> roots{domain};
    counts = {1, 1, 1};
    const auto all = octants(domain).cuts;
    for (int level = 0; long_axes(domain, level) != all; ++level) {
        const auto axes = long_axes(domain, level);
        std::vector<Box> parts;
        for (const Box& box : roots) {
            const Subdivision cut{box, box.centre(), axes};
            for (int c = 0; c < cut.children(); ++c) parts.push_back(cut.child(c));
        }
        if (parts.size() > most) {
            refuse(
                "the domain {} is too oblong for .htg, which takes more than {} octrees: name a "
                ".vtu",
                to_string(domain), most);
        }
        for (std::size_t a = 0; a < 3; ++a) counts[a] *= axes[a] ? 2 : 1;
        roots = std::move(parts);
    }
    std::ranges::sort(roots, {}, [](const Box& root) {
        return std::tuple(root.low.z(), root.low.y(), root.low.x());
    });
    return roots;
}

/// What is below one of the roots, breadth first.
VtkTree tree_below(const ControlSpace& space, const Box& root) {
    VtkTree tree;
    std::vector<Box> boxes{root};
    std::vector<Point> centres;
    while (tree.is_split.size() < boxes.size()) {
        const std::size_t level_end = boxes.size();
        tree.level_counts.push_back(static_cast<std::int64_t>(level_end - tree.is_split.size()));
        for (std::size_t i = tree.is_split.size(); i < level_end; ++i) {
            const Box box = boxes[i];
            centres.push_back(box.centre());
            const Box leaf = space.cell_at(box.centre()).value_or(Box());
            const bool is_part_of_leaf =
                leaf == box || (i == 0 && leaf.contains(box.low) && leaf.contains(box.high));
            tree.is_split.push_back(!is_part_of_leaf);
            if (is_part_of_leaf) continue;
            const Subdivision subdivision = octants(box);
            const bool is_inside = box.contains(leaf.low) && box.contains(leaf.high);
            if (!is_inside || !subdivision.is_proper()) {
                refuse("only an octree can be written as .htg: choose one, or name a .vtu");
            }
            for (int c = 0; c < subdivision.children(); ++c) {
                boxes.push_back(subdivision.child(c));
            }
        }
    }
    tree.cell_data = metric_arrays(sample_parallel(space, centres));
    return tree;
}

}  // namespace

void write_leaves(const std::filesystem::path& path, const ControlSpace& space) {
    write_leaves(path, space, std::vector{space.domain()});
}

void write_leaves(const std::filesystem::path& path, const ControlSpace& space,
                  std::span<const Box> regions) {
    const std::vector<Box> leaves = elements_of(space, regions);
    const std::vector<Point> corners = corners_of(leaves);
    const std::vector<int> order = cell_corners(space.domain());
    VtkCells cells{order.size() == 8 ? VtkCells::hexahedron : VtkCells::quad, order.size(), {}};
    std::vector<Point> centres;
    for (const Box& box : leaves) {
        centres.push_back(box.centre());
        for (const int i : order) {
            const auto place = std::ranges::lower_bound(corners, corner(box, i), precedes);
            cells.points.push_back(place - corners.begin());
        }
    }
    write_vtk_grid(path, corners, cells, {}, metric_arrays(sample_parallel(space, centres)));
}

void write_leaf_pieces(const std::filesystem::path& path,
                       std::span<const std::filesystem::path> pieces) {
    write_vtk_pieces(path, pieces, metric_arrays({}));
}

void write_nodes(const std::filesystem::path& path, const ControlSpace& space) {
    const auto nodes = control_nodes(space, Neighbourhood::faces);
    if (!nodes) refuse("this field has no control nodes: write a slice of it");
    write_points(path, positions(nodes->graph), nodes->metrics);
}

void write_octree(const std::filesystem::path& path, const ControlSpace& space) {
    std::array<int, 3> counts;
    std::vector<VtkTree> trees;
    for (const Box& root : octree_roots(space.domain(), counts)) {
        trees.push_back(tree_below(space, root));
    }
    write_vtk_octrees(path, space.domain(), counts, trees);
}

void require_slice_samples(int samples) {
    if (samples >= 2 && samples <= 8192) return;
    refuse("{} samples: give 2 to 8192", samples);
}

void write_slice(const std::filesystem::path& path, const ControlSpace& field, const Box& domain,
                 const Slice& slice) {
    require_slice_samples(slice.samples);
    const Raster raster = raster_of(domain, slice);
    std::vector<Point> places;
    for (std::size_t j = 0; j < raster.rows(); ++j) {
        for (std::size_t i = 0; i < raster.columns(); ++i) places.push_back(raster.at(i, j));
    }
    write_vtk_image(path, raster.origin, raster.spacing, raster.counts,
                    metric_arrays(sample_parallel(field, places)));
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
