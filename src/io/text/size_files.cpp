// SPDX-License-Identifier: Apache-2.0
// Lengths on regular grids (Gmsh's Structured, JIGSAW's EUCLIDEAN-GRID), and at points (Netgen).
#include "io/text/size_files.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "controlspace/geometry/extent.h"
#include "controlspace/geometry/subdivision.h"
#include "controlspace/metric/blend.h"
#include "files/output_file.h"
#include "io/text/cells.h"
#include "io/text/lengths_at.h"
#include "refuse.h"

namespace controlspace {
namespace {

struct Grid {
    Point low;
    Vector spacing;
    Eigen::Array3i counts;
    std::vector<double> lengths;  ///< z fastest, x slowest
    bool has_tensors = false;

    double coordinate(Axis a, int i) const { return low[a] + spacing[a] * i; }
    std::size_t index(const Eigen::Array3i& node) const {
        const Eigen::Array<std::size_t, 3, 1> n = node.cast<std::size_t>(),
                                              of = counts.cast<std::size_t>();
        return (n[0] * of[1] + n[1]) * of[2] + n[2];
    }
    double trilinear(const Point& x) const {
        const Eigen::Array3d steps = (x - low).cwiseQuotient(spacing);
        const Eigen::Array3i cell = steps.cast<int>().max(0).min(counts - 2);
        const auto weights = corner_weights((steps - cell.cast<double>()).max(0).min(1).matrix());
        double length = 0;
        for (int c = 0; c < 8; ++c) {
            length += weights[static_cast<std::size_t>(c)] *
                      lengths[index(cell + Eigen::Array3i(c & 1, c >> 1 & 1, c >> 2))];
        }
        return length;
    }
};

Grid sampled(const ControlSpace& space, int samples) {
    require_grid_samples(samples);
    const Box domain = space.domain();
    const Eigen::Array3d edges = domain.edges();
    const double longest = edges.maxCoeff();
    const Eigen::Array3d steps = (edges / longest * (samples - 1)).round().max(1);
    // Across a plane two layers, as far apart as the nodes are along it.
    Grid grid{domain.low,
              (edges > 0).select(edges, longest / (samples - 1)) / steps,
              steps.cast<int>() + 1,
              {}};
    std::vector<Point> plane;
    for (int i = 0; i < grid.counts[0]; ++i) {
        plane.clear();
        for (int j = 0; j < grid.counts[1]; ++j) {
            for (int k = 0; k < grid.counts[2]; ++k) {
                plane.emplace_back(grid.coordinate(0, i), grid.coordinate(1, j),
                                   grid.coordinate(2, k));
            }
        }
        const Lengths of_plane = lengths_at(space, plane);
        grid.lengths.insert(grid.lengths.end(), of_plane.values.begin(), of_plane.values.end());
        grid.has_tensors = grid.has_tensors || of_plane.has_tensors;
    }
    return grid;
}

SizeFile summary(const Grid& grid, const ControlSpace& space) {
    return {grid.lengths.size(), grid.has_tensors,
            usual_factor(space, [&](const Point& x) { return grid.trilinear(x); })};
}

}  // namespace

void require_grid_samples(int samples) {
    constexpr int fewest = 2, most = 512;
    if (samples >= fewest && samples <= most) return;
    refuse("{} samples along the longest edge: give {} to {}", samples, fewest, most);
}

SizeFile write_gmsh_structured(const std::filesystem::path& path, const ControlSpace& space,
                               int samples) {
    const Grid grid = sampled(space, samples);
    OutputFile file(path);
    file.write_raw(grid.low.data(), 3);
    file.write_raw(grid.spacing.data(), 3);
    file.write_raw(grid.counts.data(), 3);
    file.write_raw(grid.lengths.data(), grid.lengths.size());
    file.commit();
    return summary(grid, space);
}

SizeFile write_jigsaw_grid(const std::filesystem::path& path, const ControlSpace& space,
                           int samples) {
    const std::optional<Axis> flat = flat_axis(space.domain());
    if (flat && *flat != 2) {
        refuse_at(path,
                  "JIGSAW's planes lie across z, and the domain {} does not: write another format",
                  to_string(space.domain()));
    }
    const int dimensions = flat ? 2 : 3;
    const Grid grid = sampled(space, samples);
    OutputFile file(path);
    file.write("# Lengths for JIGSAW: hfun_file, with hfun_scal = absolute\n");
    file.print("MSHID=3;EUCLIDEAN-GRID\nNDIMS={}\n", dimensions);
    for (Axis a = 0; a < dimensions; ++a) {
        const int count = grid.counts[a];
        file.print("COORD={};{}\n", a + 1, count);
        for (int i = 0; i < count; ++i) file.print("{}\n", grid.coordinate(a, i));
    }
    const int layers = flat ? 1 : grid.counts[2];
    file.print("VALUE={};1\n", layers * grid.counts[0] * grid.counts[1]);
    for (int k = 0; k < layers; ++k) {  // y fastest, z slowest
        for (int i = 0; i < grid.counts[0]; ++i) {
            for (int j = 0; j < grid.counts[1]; ++j) {
                file.print("{}\n", static_cast<float>(grid.lengths[grid.index({i, j, k})]));
            }
        }
    }
    file.commit();
    return summary(grid, space);
}

SizeFile write_netgen_sizes(const std::filesystem::path& path, const ControlSpace& space) {
    constexpr std::size_t most_points = 20'000'000;
    constexpr double spacing =
        0.5;  // lengths: at 1, Netgen's are up to 1.4 times too large between
    std::vector<std::pair<double, Point>> points;
    bool has_tensors = false;
    std::vector<Box> boxes = elements_of(space);
    while (!boxes.empty()) {
        std::vector<Point> centres;
        centres.reserve(boxes.size());
        for (const Box& box : boxes) centres.push_back(box.centre());
        const Lengths lengths = lengths_at(space, centres);
        has_tensors = has_tensors || lengths.has_tensors;
        std::vector<Box> parts;
        for (std::size_t i = 0; i < boxes.size(); ++i) {
            // Along short edges of a cell there is room for one point.
            Subdivision cut = octants(boxes[i]);
            for (Axis a = 0; a < 3; ++a) {
                cut.cuts[static_cast<std::size_t>(a)] =
                    boxes[i].edges()[a] > spacing * lengths.values[i];
            }
            if (cut.children() == 1 || !cut.is_proper()) {
                points.emplace_back(lengths.values[i], centres[i]);
            } else {
                for (int c = 0; c < cut.children(); ++c) parts.push_back(cut.child(c));
            }
        }
        if (points.size() + parts.size() > most_points) {
            refuse(
                "the field requests more than 20 million points, too many for Netgen: give "
                "larger lengths, or a smaller --domain");
        }
        boxes = std::move(parts);
    }
    // Netgen passes over a point where its length is small enough already.
    std::ranges::stable_sort(points, {}, [](const auto& point) { return point.first; });
    OutputFile file(path);
    file.print("{}\n", points.size());
    for (const auto& [length, x] : points) file.print("{} {} {} {}\n", x.x(), x.y(), x.z(), length);
    file.write("0\n");  // lines
    file.commit();
    return {points.size(), has_tensors};
}

}  // namespace controlspace
