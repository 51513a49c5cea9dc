// SPDX-License-Identifier: Apache-2.0
#include "controlspace/io/write_lengths.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <vector>

#include "controlspace/io/read_sources.h"
#include "files/output_file.h"
#include "io/text/npy.h"
#include "io/text/vtk_xml.h"
#include "refuse.h"

namespace controlspace {
namespace {

static_assert(std::endian::native == std::endian::little, "the files say so");

constexpr std::size_t tile = 64;  // columns and rows

void sample_tile(const ControlSpace& space, const Raster& raster, std::size_t first_row,
                 std::size_t rows, std::size_t first_column, std::span<double> band) {
    const std::size_t columns = std::min(tile, raster.columns() - first_column);
    std::vector<Point> places;
    places.reserve(rows * columns);
    for (std::size_t j = 0; j < rows; ++j) {
        for (std::size_t i = 0; i < columns; ++i) {
            places.push_back(raster.at(first_column + i, first_row + j));
        }
    }
    std::vector<double> lengths(places.size());
    space.sample_lengths(places, lengths);
    for (std::size_t j = 0; j < rows; ++j) {
        std::copy_n(lengths.data() + j * columns, columns,
                    band.data() + j * raster.columns() + first_column);
    }
}

}  // namespace

Point Raster::at(std::size_t column, std::size_t row) const {
    Point p = origin;
    p[axes[0]] += spacing[axes[0]] * static_cast<double>(column);
    p[axes[1]] += spacing[axes[1]] * static_cast<double>(row);
    return p;
}

Raster raster_of(const Box& domain, const Slice& slice) {
    constexpr int most = 1 << 17;
    if (slice.samples < 2 || slice.samples > most) {
        refuse("{} samples: give 2 to {}", slice.samples, most);
    }
    if (!(slice.at >= domain.low[slice.axis] && slice.at <= domain.high[slice.axis])) {
        refuse("a slice at {} = {} is outside the domain {}", "xyz"[slice.axis], slice.at,
               to_string(domain));
    }
    Vector edges = domain.edges();
    edges[slice.axis] = 0;
    Raster raster{domain.low, Vector::Ones(), {1, 1, 1}};
    raster.origin[slice.axis] = slice.at;
    for (Axis a = 0; a < 3; ++a) {
        if (edges[a] == 0) continue;
        const double steps =
            std::max(1.0, std::round(edges[a] / edges.maxCoeff() * (slice.samples - 1)));
        raster.counts[static_cast<std::size_t>(a)] = static_cast<int>(steps) + 1;
        raster.spacing[a] = edges[a] / steps;
    }
    raster.axes = {slice.axis == 0 ? 1 : 0, slice.axis == 2 ? 1 : 2};
    return raster;
}

void for_each_band(const ControlSpace& space, const Raster& raster,
                   const std::function<void(std::span<const double>)>& use) {
    const std::size_t columns = raster.columns();
    const std::size_t tiles = (columns + tile - 1) / tile;
    std::vector<double> band(std::min(tile, raster.rows()) * columns);
    for (std::size_t row = 0; row < raster.rows(); row += tile) {
        const std::size_t rows = std::min(tile, raster.rows() - row);
        const std::span<double> lengths = std::span(band).first(rows * columns);
        tbb::parallel_for(std::size_t{0}, tiles, [&](std::size_t t) {
            sample_tile(space, raster, row, rows, t * tile, lengths);
        });
        use(lengths);
    }
}

void write_lengths(const std::filesystem::path& path, const ControlSpace& space,
                   const Raster& raster, const RasterProgress& progress) {
    require_room(path, raster.size() * sizeof(double));
    const auto [before, after] =
        lower_case_extension(path) == ".npy"
            ? std::pair(npy_header(fmt::format("{}, {}", raster.rows(), raster.columns())),
                        std::string())
            : vtk_image_frame(raster.origin, raster.spacing, raster.counts, "h",
                              raster.size() * sizeof(double));
    OutputFile file(path);
    file.write(before);
    std::size_t done = 0;
    for_each_band(space, raster, [&](std::span<const double> lengths) {
        file.write_raw(lengths.data(), lengths.size());
        progress(done += lengths.size());
    });
    file.write(after);
    file.commit();
}

}  // namespace controlspace
