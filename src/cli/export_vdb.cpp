// SPDX-License-Identifier: Apache-2.0
// The format .vdb of `export`.
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <memory>

#include "cli/export.h"
#include "cli/peak_memory.h"
#include "controlspace/io/metric_grids.h"
#include "controlspace/io/write_vdb.h"
#include "controlspace/study/provenance.h"
#include "files/text_file.h"
#include "measure/stopwatch.h"
#include "refuse.h"

namespace controlspace {
namespace {

std::vector<VdbNote> notes_of(const Export& e) {
    std::vector<VdbNote> notes;
    if (e.filled.origin) {
        const Case& c = e.filled.origin->c;
        notes = {{"structure", structure_label(c)},
                 {"law", std::string(name_of(c.law))},
                 {"g_r", c.g_r},
                 {"settings", setting_label(c)},
                 {"sources", sources_name(c.sources)}};
    } else {
        notes = {{"sources", e.input.string()}};
    }
    notes.emplace_back("version", version_text(current_provenance()));
    notes.emplace_back("command_line", e.command_line);
    return notes;
}

std::string summary(const Export& e, const VdbReport& report, const Stopwatch& time) {
    return fmt::format(
        "{}: {} x {} x {} voxels of {:.4g}, {:.0f} % of them kept, the others in tiles of 8^3; "
        "smallest lengths {:.4g} to {:.4g}\n"
        "{:.1f} MB in the file; {:.1f} s, {:.1f} s of processors, {:.0f} MB of memory at most\n",
        e.output.string(), report.counts[0], report.counts[1], report.counts[2], report.voxel,
        100 * report.kept, report.finest, report.coarsest, static_cast<double>(report.file) / 1e6,
        time.seconds(), time.processor_seconds(), static_cast<double>(peak_memory()) / 1e6);
}

std::string export_vdb(const Export& e, VdbOptions vdb) {
    const std::optional<Origin>& origin = e.filled.origin;
    const bool with_sources = std::erase(vdb.grids, sources_grid) > 0;
    vdb.notes = notes_of(e);
    e.progress.started("sampling");
    vdb.progress = [&](std::size_t done, std::size_t all) {
        e.progress.advanced(done, all, "voxels");
        if (done == all) e.progress.started("writing");
    };
    if (origin) {
        const auto& [study, c, workload] = *origin;
        vdb.max_bytes = space_options(study, c, workload).max_bytes;
        if (with_sources) vdb.sources = workload.sources.all();
    } else if (with_sources) {
        refuse("{} keeps no sources: leave them out of --grids", e.input.string());
    }
    const Stopwatch time;
    const VdbReport report = write_vdb(e.output, *e.filled.space, vdb);
    std::string text = summary(e, report, time);
    if (report.scale != 1) {
        spdlog::warn(
            "OpenVDB has no voxels of {:.4g}: places and lengths in the file are {:g} times as "
            "large (metadatum scale)",
            report.voxel, report.scale);
    }
    const double finest = origin ? origin->workload.finest_length : report.finest;
    if (report.voxel > finest) {
        spdlog::warn(
            "voxels of {:.4g} are larger than the smallest requested length, {:.4g}: give --voxel",
            report.voxel, finest);
    }
    return text;
}

VdbCompression compression_named(const std::string& name) {
    if (name == "blosc") return VdbCompression::blosc;
    if (name == "zip") return VdbCompression::zip;
    if (name == "none") return VdbCompression::none;
    refuse("--compression: {} is none of blosc, zip and none", quote(name));
}

}  // namespace

std::vector<FieldFormat> add_vdb_formats(Options& options) {
    struct Vdb {
        VdbOptions options;
        std::vector<std::string> compression{"blosc"};
    };
    const auto vdb = std::make_shared<Vdb>();
    const std::string group = "A .vdb file";
    options.add(
        {"--voxel", "NUMBER",
         "Edge of a voxel [length]; left out: 1/128 of the longest edge of the domain", group},
        vdb->options.voxel);
    options.add({"--tolerance", "NUMBER",
                 "Relative difference of lengths, in any direction, up to which voxels share a "
                 "metric; 0: only "
                 "equal metrics (default: 0.01)",
                 group},
                vdb->options.tolerance);
    std::string names;
    for (const MetricGrid& grid : metric_grids()) names += fmt::format("{}, ", grid.name);
    options.add(
        {"--grids", "TEXT,...",
         fmt::format("Grids to write, of {}and {}, the sources as points (left out: all but "
                     "these; of isotropic fields density and {})",
                     names, sources_grid, lengths_grid),
         group},
        vdb->options.grids, 0);
    options.add({"--compression", "TEXT", "blosc, zip or none (default: blosc)", group},
                vdb->compression, 1);
    options.add({"--half", "", "Numbers of 16 bits", group}, vdb->options.half);
    return {{{".vdb"},
             [vdb](const Export& e) {
                 vdb->options.compression = compression_named(vdb->compression.front());
                 return export_vdb(e, vdb->options);
             },
             {group},
             [vdb](const auto&, const auto&) { compression_named(vdb->compression.front()); }}};
}

}  // namespace controlspace
