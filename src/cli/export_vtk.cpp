// SPDX-License-Identifier: Apache-2.0
// The formats of VTK of `export`: leaves or control nodes, a slice, an octree; and a slice's
// lengths for NumPy and netCDF.
#include <fmt/format.h>

#include <memory>

#include "cli/export.h"
#include "controlspace/geometry/extent.h"
#include "controlspace/io/write_lengths.h"
#include "controlspace/io/write_vtk.h"
#include "files/text_file.h"
#include "io/netcdf/write_netcdf.h"
#include "refuse.h"

namespace controlspace {
namespace {

struct SliceOptions {
    bool lengths = false;
    std::vector<std::string> place;  ///< axis, and coordinate on it; the middle if left out
};

std::string write_grid(const Export& e, bool nodes) {
    const ControlSpace& space = *e.filled.space;
    if (nodes) {
        write_nodes(e.output, space);
        return written(e, fmt::format("{} control nodes", space.footprint().control_nodes));
    }
    write_leaves(e.output, space);
    return written(e, "the elements, with their metrics");
}

Slice slice_of(const SliceOptions& options, const Box& domain, std::optional<int> samples) {
    const std::string plain(1, "xyz"[flat_axis(domain).value_or(2)]);
    const std::string& name = options.place.empty() ? plain : options.place.front();
    const std::size_t axis = std::string("xyz").find(name);
    if (name.size() != 1 || axis > 2) refuse("--slice: {} is no axis: give x, y or z", quote(name));
    Slice slice;
    slice.axis = static_cast<Axis>(axis);
    slice.at = domain.centre()[slice.axis];
    if (samples) slice.samples = *samples;
    if (options.place.size() > 1 && !parse_number(options.place[1], slice.at)) {
        refuse("--slice: {} is not a number", quote(options.place[1]));
    }
    return slice;
}

/// A slice's lengths, by `write`.
std::string write_raster(const Export& e, const Slice& slice, const auto& write) {
    const ControlSpace& space = *e.filled.space;
    const Raster raster = raster_of(space.domain(), slice);
    write(e.output, space, raster,
          [&](std::size_t done) { e.progress.advanced(done, raster.size(), "points"); });
    return written(e, fmt::format("{} x {} lengths at {} = {}", raster.columns(), raster.rows(),
                                  "xyz"[slice.axis], slice.at));
}

std::string write_image(const Export& e, const SliceOptions& options) {
    const ControlSpace& space = *e.filled.space;
    const Slice slice = slice_of(options, space.domain(), e.samples);
    if (options.lengths) return write_raster(e, slice, write_lengths);
    write_slice(e.output, space, space.domain(), slice);
    return written(e, fmt::format("a slice at {} = {}", "xyz"[slice.axis], slice.at));
}

}  // namespace

std::vector<FieldFormat> add_vtk_formats(Options& options) {
    const auto nodes = std::make_shared<bool>(false);
    const auto slice = std::make_shared<SliceOptions>();
    const std::string grid_group = "A .vtu file", image_group = "A .vti, .npy or .nc file",
                      vti_group = "A .vti file";
    options.add({"--nodes", "", "Write control nodes in place of leaves", grid_group}, *nodes);
    options.add({"--slice", "AXIS [NUMBER]",
                 "Axis across the slice (x, y or z) and coordinate on it [length]; left out: z, or "
                 "the axis across a flat domain, and the middle of the domain",
                 image_group},
                slice->place, 2);
    options.add({"--lengths", "",
                 "Write the smallest lengths alone, as .npy and .nc do, band by band", vti_group},
                slice->lengths);
    const auto check = [slice](bool lengths, std::optional<int> samples) {
        const Box any{Point::Zero(), Point::Ones()};
        Slice wanted = slice_of(*slice, any, samples);
        if (!lengths) require_slice_samples(wanted.samples);
        wanted.at = 0;  // whether it is in the domain is not known yet
        raster_of(any, wanted);
    };
    const auto raster_format = [slice, check, image_group](const char* ending, auto write) {
        return FieldFormat{{ending},
                           [slice, write](const Export& e) {
                               return write_raster(
                                   e, slice_of(*slice, e.filled.space->domain(), e.samples), write);
                           },
                           {image_group, samples_group},
                           [check](const auto&, auto samples) { check(true, samples); }};
    };
    return {{{".vtu"}, [nodes](const Export& e) { return write_grid(e, *nodes); }, {grid_group}},
            {{".vti"},
             [slice](const Export& e) { return write_image(e, *slice); },
             {image_group, samples_group, vti_group},
             [slice, check](const auto&, auto samples) { check(slice->lengths, samples); }},
            raster_format(".npy", write_lengths),
            raster_format(".nc", write_netcdf),
            {{".htg"}, [](const Export& e) {
                 write_octree(e.output, *e.filled.space);
                 return written(e, "an octree");
             }}};
}

}  // namespace controlspace
