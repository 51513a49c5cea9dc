#include "app/export_vdb.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <chrono>
#include <ctime>

#include "app/peak_memory.h"
#include "study/names.h"
#include "study/provenance.h"

namespace controlspace {
namespace {

std::vector<VdbNote> notes_of(const Case& c, const std::string& command_line) {
    return {{"structure", structure_label(c)},
            {"law", std::string(name_of(c.law))},
            {"g_r", c.g_r},
            {"settings", setting_label(c)},
            {"sources", sources_name(c.sources)},
            {"version", version_text(current_provenance())},
            {"command_line", command_line}};
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

std::string export_vdb(const ExportOptions& options, const Study& study, const Case& c,
                       const Workload& workload, const ControlSpace& space) {
    VdbOptions vdb = options.vdb;
    vdb.notes = notes_of(c, options.command_line);
    vdb.max_bytes = space_options(study, c, workload).max_bytes;
    if (options.with_sources) vdb.sources = workload.sources;
    const auto start = std::chrono::steady_clock::now();
    const std::clock_t processor_start = std::clock();
    const VdbReport report = write_vdb(options.output, space, vdb);
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
    const auto ticks = static_cast<double>(std::clock() - processor_start);
    if (report.voxel > workload.finest_length) {
        spdlog::warn(
            "voxels of {:.4g} are larger than the smallest length asked for, {:.4g}: give --voxel "
            "to see all of it",
            report.voxel, workload.finest_length);
    }
    return summary(options.output, report, {seconds.count(), ticks / CLOCKS_PER_SEC});
}

}  // namespace controlspace
