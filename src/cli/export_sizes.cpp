// SPDX-License-Identifier: Apache-2.0
// Formats of `export` for meshers that take one length a place: Gmsh, JIGSAW, Netgen and TetGen.
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <cmath>
#include <filesystem>
#include <span>
#include <vector>

#include "cli/export.h"
#include "io/text/size_files.h"
#include "refuse.h"

namespace controlspace {
namespace {

/// "FILE: 81 nodes for JIGSAW; 99 % of 1000 random places within 1.02x; 1.2 MB"; what the mesher
/// does not see is a warning.
std::string report(const Export& e, const SizeFile& file, const std::string& what,
                   const std::string& remedy, std::span<const std::filesystem::path> files = {}) {
    constexpr double far = 1.25;
    if (file.has_tensors) {
        spdlog::warn(
            "{} holds one length a place, the smallest of each tensor: for MMG, which follows "
            "tensors, write a .sol",
            e.output.string());
    }
    std::string text = fmt::format("{} {}", file.count, what);
    if (file.within) {
        text += fmt::format("; 99 % of 1000 random places within {:.2f}x of the structure",
                            std::ceil(100 * *file.within) / 100);
        if (*file.within > far) spdlog::warn("{}: {}", e.output.string(), remedy);
    }
    return written(e, text, files);
}

/// A format of lengths at the nodes of a grid, which are `what`.
FieldFormat grid_format(const char* ending, const char* what, auto write) {
    return {{ending},
            [what, write](const Export& e) {
                const int samples = e.samples.value_or(grid_samples);
                return report(e, write(e.output, *e.filled.space, samples), what,
                              "lengths are off by more than 1.25x: give more --samples");
            },
            {samples_group},
            [](const auto&, std::optional<int> samples) {
                if (samples) require_grid_samples(*samples);
            }};
}

std::string write_netgen(const Export& e) {
    return report(e, write_netgen_sizes(e.output, *e.filled.space),
                  "points with mesh sizes for Netgen", "");
}

/// NAME.b, of whose three files the output names one. NAME.node itself is TetGen's input.
std::filesystem::path background_base(const std::filesystem::path& output) {
    std::filesystem::path base = output;
    base.replace_extension();
    if (base.extension() == ".b") return base;
    refuse_at(output,
              "TetGen reads the background mesh of NAME.poly from NAME.b.node, NAME.b.ele and "
              "NAME.b.mtr: name {}.b{}",
              base.string(), output.extension().string());
}

/// Of the input that goes with the background mesh NAME.b, if it is there already.
std::vector<Point> tetgen_points(std::filesystem::path base) {
    base.replace_extension();
    for (const char* ending : {".poly", ".smesh", ".node"}) {
        std::filesystem::path file = base;
        file += ending;
        if (!std::filesystem::is_regular_file(file)) continue;
        try {
            std::vector<Point> points = read_tetgen_points(file);
            if (!points.empty()) return points;  // a .poly may leave them to its .node
        } catch (const InputError& error) {
            spdlog::warn("{}: not compared with the domain of the field", error.what());
        }
    }
    return {};
}

std::string write_tetgen(const Export& e) {
    const std::filesystem::path base = background_base(e.output);
    std::vector<std::filesystem::path> files(3, base);
    files[0] += ".node";
    files[1] += ".ele";
    files[2] += ".mtr";
    for (const std::filesystem::path& file : files) e.progress.writes(file);
    report_outside(tetgen_points(base), "points of TetGen's input", e.filled.space->domain());
    return report(e, write_tetgen_background(base, *e.filled.space),
                  "nodes of a background mesh for TetGen (-m), in three files",
                  "lengths are off by more than 1.25x, as they jump in this structure: write one "
                  "with smaller jumps (K_oV, --within 1.1)",
                  files);
}

}  // namespace

std::vector<FieldFormat> add_size_formats(Options&) {
    return {grid_format(".structured",
                        "nodes of a field Structured of Gmsh (TextFormat = 0, SetOutsideValue = 0)",
                        write_gmsh_structured),
            grid_format(".msh", "nodes of a grid for JIGSAW (hfun_file, hfun_scal = absolute)",
                        write_jigsaw_grid),
            {{".msz"}, write_netgen},
            {{".node", ".ele", ".mtr"},
             write_tetgen,
             {},
             [](const std::filesystem::path& output, const auto&) { background_base(output); }}};
}

}  // namespace controlspace
