#include "cli/export_vdb.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <chrono>
#include <ctime>

#include "cli/peak_memory.h"
#include "controlspace/error.h"
#include "study/names.h"
#include "study/provenance.h"

namespace controlspace {
namespace {

std::vector<VdbNote> notes_of(const ExportOptions& options, const std::optional<Origin>& origin) {
    std::vector<VdbNote> notes;
    if (origin) {
        const Case& c = origin->c;
        notes = {{"structure", structure_label(c)},
                 {"law", std::string(name_of(c.law))},
                 {"g_r", c.g_r},
                 {"settings", setting_label(c)},
                 {"sources", sources_name(c.sources)}};
    } else {
        notes = {{"sources", options.input.string()}};
    }
    notes.emplace_back("version", version_text(current_provenance()));
    notes.emplace_back("command_line", options.command_line);
    return notes;
}

/// What writing took.
struct Cost {
    double seconds;
    double processor_seconds;
};

std::string summary(const std::filesystem::path& path, const VdbReport& report, const Cost& cost) {
    return fmt::format(
        "{}: {} x {} x {} voxels of {:.4g}, {:.0f} % of them kept, the others in tiles of 8^3; "
        "smallest lengths {:.4g} to {:.4g}\n"
        "{:.1f} MB in the file; {:.1f} s, {:.1f} s of processors, {:.0f} MB of memory at most\n",
        path.string(), report.counts[0], report.counts[1], report.counts[2], report.voxel,
        100 * report.kept, report.finest, report.coarsest, static_cast<double>(report.file) / 1e6,
        cost.seconds, cost.processor_seconds, static_cast<double>(peak_memory()) / 1e6);
}

}  // namespace

std::string export_vdb(const ExportOptions& options, const FilledSpace& filled,
                       StepProgress& progress) {
    const std::optional<Origin>& origin = filled.origin;
    VdbOptions vdb = options.vdb;
    vdb.notes = notes_of(options, origin);
    progress.started("sampling");
    vdb.progress = [&](std::size_t done, std::size_t all) {
        progress.advanced(done, all, "voxels");
        if (done == all) progress.started("writing");
    };
    if (origin) {
        const auto& [study, c, workload] = *origin;
        vdb.max_bytes = space_options(study, c, workload).max_bytes;
        if (options.with_sources) vdb.sources = workload.sources;
    } else if (options.with_sources) {
        throw InputError(
            fmt::format("{} keeps no sources: leave them out of --grids", options.input.string()));
    }
    const auto start = std::chrono::steady_clock::now();
    const std::clock_t processor_start = std::clock();
    const VdbReport report = write_vdb(options.output, *filled.space, vdb);
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
    const auto ticks = static_cast<double>(std::clock() - processor_start);
    const double finest = origin ? origin->workload.finest_length : report.finest;
    if (report.voxel > finest) {
        spdlog::warn(
            "voxels of {:.4g} are larger than the smallest length asked for, {:.4g}: give --voxel "
            "to see all of it",
            report.voxel, finest);
    }
    return summary(options.output, report, {seconds.count(), ticks / CLOCKS_PER_SEC});
}

}  // namespace controlspace
