// SPDX-License-Identifier: Apache-2.0
#include "study/sampled_fields.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <string>

#include "controlspace/geometry/extent.h"
#include "controlspace/space/sample_parallel.h"
#include "controlspace/study/results.h"
#include "io/text/npy.h"

namespace controlspace {
namespace {

/// More outlines would cover what they are drawn on.
constexpr std::size_t most_cells = 20000;

using Numbers = std::vector<double>;

std::vector<Point> slice_places(const Box& domain, double z) {
    const auto [u, v] = slice_axes(domain);
    const Vector cell = domain.edges() / slice_cells;
    std::vector<Point> places;
    for (int j = 0; j < slice_cells; ++j) {
        for (int i = 0; i < slice_cells; ++i) {
            Point x = Point::Constant(z);
            x[u] = domain.low[u] + (i + 0.5) * cell[u];
            x[v] = domain.low[v] + (j + 0.5) * cell[v];
            places.push_back(x);
        }
    }
    return places;
}

Numbers numbers_of(std::span<const Metric> metrics) {
    Numbers numbers;
    numbers.reserve(6 * metrics.size());
    for (const Metric& m : metrics) {
        numbers.insert(numbers.end(), {m.xx, m.yy, m.zz, m.xy, m.xz, m.yz});
    }
    return numbers;
}

Numbers sampled(const ControlSpace& space, std::span<const Point> places) {
    return numbers_of(sample_parallel(space, places));
}

}  // namespace

void write_npy(const std::filesystem::path& path, std::span<const std::size_t> shape,
               std::span<const double> numbers) {
    std::string text = npy_header(fmt::format("{},", fmt::join(shape, ", ")));
    text.append(reinterpret_cast<const char*>(numbers.data()), numbers.size_bytes());
    replace_file(path, text);
}

std::array<Axis, 2> slice_axes(const Box& domain) {
    const auto flat = flat_axis(domain);
    return {flat == 0 ? 1 : 0, flat == 0 || flat == 1 ? 2 : 1};
}

std::optional<std::vector<Box>> cells_on_slice(const ControlSpace& space, double z,
                                               std::size_t most) {
    const Box domain = space.domain();
    const auto [u, v] = slice_axes(domain);
    const Vector inside = 1e-9 * domain.edges();
    std::vector<Box> cells;
    Point x = Point::Constant(z);
    // Rows of cells from below: none ends between one row's height and the next, so that each cell
    // is met at its lower side.
    for (double y = domain.low[v]; y < domain.high[v] - inside[v];) {
        double next_y = domain.high[v];
        x[v] = y + inside[v];
        for (x[u] = domain.low[u]; x[u] < domain.high[u] - inside[u];) {
            const double from = x[u];
            x[u] += inside[u];
            const auto cell = space.cell_at(x);
            if (!cell) return std::nullopt;
            if (cell->low[v] >= y - inside[v]) cells.push_back(*cell);
            if (cells.size() > most) return std::nullopt;
            next_y = std::min(next_y, cell->high[v]);
            x[u] = std::max(cell->high[u], from + inside[u]);
        }
        y = std::max(next_y, y + inside[v]);
    }
    return cells;
}

FieldFiles write_sampled_fields(const std::filesystem::path& folder, const Finished& finished,
                                bool has_exact) {
    const Box& domain = finished.workload.domain;
    const auto [x_cells, y_cells, z_cells] = cell_counts(domain, finished.study.probe_grid);
    const auto nx = static_cast<std::size_t>(x_cells), ny = static_cast<std::size_t>(y_cells),
               nz = static_cast<std::size_t>(z_cells);
    constexpr std::size_t m = slice_cells;
    const Axis across = flat_axis(domain).value_or(2);
    FieldFiles files{domain, domain.centre()[across], "", "", "", "", ""};
    std::filesystem::create_directories(folder / "fields");
    const auto write = [&](std::string& name, const std::string& stem, const char* what,
                           std::initializer_list<std::size_t> shape, const Numbers& numbers) {
        name = fmt::format("fields/{}-{}.npy", stem, what);
        write_npy(folder / name, shape, numbers);
    };
    const std::vector<Point> slice = slice_places(domain, files.z);
    const std::vector<Point>& probes = finished.probes.coarse.points;
    const std::string stem = fmt::format("{:03}", finished.index);
    write(files.slice, stem, "slice", {m, m, 6}, sampled(finished.space, slice));
    write(files.probes, stem, "probes", {nz, ny, nx, 6}, sampled(finished.space, probes));
    if (const auto cells = cells_on_slice(finished.space, files.z, most_cells)) {
        const auto [u, v] = slice_axes(domain);
        Numbers outlines;
        for (const Box& c : *cells) {
            outlines.insert(outlines.end(), {c.low[u], c.low[v], c.high[u], c.high[v]});
        }
        write(files.outlines, stem, "outlines", {cells->size(), 4}, outlines);
    }
    files.exact_slice = "fields/exact-slice.npy";
    files.exact_probes = "fields/exact-probes.npy";
    if (!has_exact) {
        const auto reference = make_reference(finished.study, finished.setting, finished.workload);
        write(files.exact_slice, "exact", "slice", {m, m, 6}, sampled(*reference, slice));
        write(files.exact_probes, "exact", "probes", {nz, ny, nx, 6},
              numbers_of(finished.probes.coarse.reference));
    }
    return files;
}

}  // namespace controlspace
