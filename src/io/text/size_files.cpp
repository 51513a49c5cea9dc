// Lengths on regular grids (Gmsh's Structured, JIGSAW's EUCLIDEAN-GRID), and at points (Netgen).
#include "io/text/size_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "controlspace/error.h"
#include "controlspace/geometry/extent.h"
#include "controlspace/geometry/subdivision.h"
#include "controlspace/metric/blend.h"
#include "files/output_file.h"
#include "io/text/cells.h"
#include "io/text/lengths_at.h"

namespace controlspace {
namespace {

struct Grid {
    Point low;
    Vector spacing;
    std::array<int, 3> counts;
    std::vector<double> lengths;  ///< z fastest, x slowest
    bool has_tensors = false;

    double coordinate(Axis a, int i) const { return low[a] + spacing[a] * i; }
    std::size_t index(int i, int j, int k) const {
        const auto n = [](int x) { return static_cast<std::size_t>(x); };
        return (n(i) * n(counts[1]) + n(j)) * n(counts[2]) + n(k);
    }
    double trilinear(const Point& x) const {
        std::array<int, 3> cell{};
        Vector t;
        for (Axis a = 0; a < 3; ++a) {
            const double steps = (x[a] - low[a]) / spacing[a];
            const int last = counts[static_cast<std::size_t>(a)] - 2;
            int& i = cell[static_cast<std::size_t>(a)];
            i = std::clamp(static_cast<int>(steps), 0, last);
            t[a] = std::clamp(steps - i, 0.0, 1.0);
        }
        double length = 0;
        const auto weights = corner_weights(t);
        for (int c = 0; c < 8; ++c) {
            length += weights[static_cast<std::size_t>(c)] *
                      lengths[index(cell[0] + (c & 1), cell[1] + (c >> 1 & 1), cell[2] + (c >> 2))];
        }
        return length;
    }
};

Grid sampled(const ControlSpace& space, int samples) {
    require_grid_samples(samples);
    const Box domain = space.domain();
    const Vector edges = domain.edges();
    Grid grid{domain.low, {}, {}, {}};
    for (Axis a = 0; a < 3; ++a) {
        const double steps = std::max(1.0, std::round(edges[a] / edges.maxCoeff() * (samples - 1)));
        grid.counts[static_cast<std::size_t>(a)] = static_cast<int>(steps) + 1;
        // Across a plane two layers, as far apart as the nodes are along it.
        grid.spacing[a] = (edges[a] > 0 ? edges[a] : edges.maxCoeff() / (samples - 1)) / steps;
    }
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
    throw InputError(
        fmt::format("{} samples along the longest edge: give {} to {}", samples, fewest, most));
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
        throw InputError(fmt::format(
            "{}: JIGSAW's planes lie across z, and the domain {} does not: write another format",
            path.string(), to_string(space.domain())));
    }
    const int dimensions = flat ? 2 : 3;
    const Grid grid = sampled(space, samples);
    OutputFile file(path);
    file.write("# Lengths for JIGSAW: hfun_file, with hfun_scal = absolute\n");
    file.print("MSHID=3;EUCLIDEAN-GRID\nNDIMS={}\n", dimensions);
    for (Axis a = 0; a < dimensions; ++a) {
        const int count = grid.counts[static_cast<std::size_t>(a)];
        file.print("COORD={};{}\n", a + 1, count);
        for (int i = 0; i < count; ++i) file.print("{}\n", grid.coordinate(a, i));
    }
    const int layers = flat ? 1 : grid.counts[2];
    file.print("VALUE={};1\n", layers * grid.counts[0] * grid.counts[1]);
    for (int k = 0; k < layers; ++k) {  // y fastest, z slowest
        for (int i = 0; i < grid.counts[0]; ++i) {
            for (int j = 0; j < grid.counts[1]; ++j) {
                file.print("{}\n", static_cast<float>(grid.lengths[grid.index(i, j, k)]));
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
            throw InputError(
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
