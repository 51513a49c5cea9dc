// SPDX-License-Identifier: Apache-2.0
#include "study/forecast.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "controlspace/geometry/extent.h"
#include "measure/stopwatch.h"
#include "refuse.h"
#include "study/text_table.h"
#include "study/time_estimate.h"

namespace controlspace {
namespace {

/// The `count` sources nearest to the one in the middle of the list: as close together as all are.
std::vector<PointSource> patch_of(std::vector<PointSource> sources, std::size_t count) {
    if (count >= sources.size()) return sources;
    const Point centre = sources[sources.size() / 2].position;
    std::ranges::nth_element(
        sources, sources.begin() + static_cast<std::ptrdiff_t>(count), {},
        [&](const PointSource& source) { return (source.position - centre).squaredNorm(); });
    sources.resize(count);
    return sources;
}

struct Trial {
    Eigen::Array2d cost;       ///< seconds to make and grade the structure, and its bytes
    double query_seconds = 0;  ///< for each place
};

/// Throws InputError where the trial takes too long to be one.
Trial try_case(const PreparedStudy& prepared, const Case& c, const Workload& workload) {
    constexpr auto longest = std::chrono::seconds(5);
    RowLimits limits;
    limits.growth.deadline = GrowthLimit::Clock::now() + longest;
    const Stopwatch time;
    const Filled filled = make_and_fill(prepared.study(), c, prepared.rows(), workload, {}, limits);
    if (!filled.creation.stopped.empty()) refuse("the trial was stopped");
    const double seconds = time.seconds();
    const auto& space = filled.space;
    const auto places = random_points(workload.domain, 1000, 1);
    return {{seconds, static_cast<double>(space->footprint().bytes_total())},
            1e-9 * access_time(*space, places, 3).median_ns()};
}

/// A grid, by one with fewer voxels.
Trial forecast_grid(const PreparedStudy& prepared, Case c, const Workload& workload) {
    constexpr double voxels_of_trial = 1e5;
    const SpaceOptions options =
        space_options(prepared.study(), c, workload, prepared.rows().parameters);
    const double voxel = options.voxel > 0 ? options.voxel : options.l_min * options.finest_length;
    const double dimensions = flat_axis(workload.domain) ? 2 : 3;
    const double voxels = measure(workload.domain) / std::pow(voxel, dimensions);
    const double factor = std::max(1.0, voxels / voxels_of_trial);
    c.voxel = voxel * std::pow(factor, 1 / dimensions);
    Trial trial = try_case(prepared, c, workload);
    trial.cost *= factor;
    // Grids that outgrow the cap become coarser.
    trial.cost *= std::min(1.0, static_cast<double>(options.max_bytes) / trial.cost[1]);
    return trial;
}

/// Anything else, from two patches of sources: what they have in common does not grow.
Trial forecast_patches(const PreparedStudy& prepared, const Case& c, const Workload& workload) {
    // Trees that follow tensors take a hundred times as long for each.
    const std::size_t sources_of_trial = c.target_delta && has_tensors(workload) ? 400 : 4000;
    Workload patch = workload;
    std::vector<PointSource> sources = patch_of(workload.sources.all(), sources_of_trial);
    patch.sources = columns_of(sources);
    Trial trial = try_case(prepared, c, patch);
    if (patch.sources.size() == workload.sources.size()) return trial;
    patch.sources = columns_of(patch_of(std::move(sources), sources_of_trial / 2));
    const double steps = static_cast<double>(workload.sources.size() - sources_of_trial) /
                         (static_cast<double>(sources_of_trial) / 2);
    trial.cost += steps * (trial.cost - try_case(prepared, c, patch).cost).max(0);
    return trial;
}

/// Seconds that the reference takes for all probes.
double probes_seconds(const Study& study, const Case& c, const Workload& workload, double probes) {
    constexpr std::size_t places = 200;
    Stopwatch time;
    const auto field = make_reference(study, c, workload);
    const double making = time.seconds();
    time = {};
    make_probes(*field, random_points(workload.domain, places, 1));
    return making + time.seconds() * probes / static_cast<double>(places);
}

double cubed(int n) { return std::pow(n, 3); }

/// None where only running the case shows its cost.
std::optional<Forecast> forecast_case(const PreparedStudy& prepared, std::size_t i) {
    const Study& study = prepared.study();
    const Case& c = prepared.cases()[i];
    if (c.equal_delta || c.equal_memory || has_field(c.sources)) return {};
    const Workload& workload = prepared.workload(c);
    const double probes = cubed(study.probe_grid) + cubed(study.fine_probe_grid);
    const double timed =  // each run is preceded by one that is not timed
        2 * study.access_repeats *
        ((has_tensors(workload) ? 4.0 : 6.0) * static_cast<double>(study.access_points) +
         cubed(study.probe_grid));
    // Grids that choose their voxels for a target choose them by a patch, too.
    const Trial trial = prepared.entry(c).has<VoxelSize>() && (!c.target_delta || c.voxel)
                            ? forecast_grid(prepared, c, workload)
                            : forecast_patches(prepared, c, workload);
    Forecast forecast{
        study.creation_repeats * trial.cost[0] + trial.query_seconds * (timed + probes),
        trial.cost[1]};
    const auto shares = [&](const Case& earlier) { return share_probes(earlier, c); };
    if (std::ranges::none_of(prepared.cases().first(i), shares)) {
        forecast.seconds += probes_seconds(study, c, workload, probes);
    }
    return forecast;
}

}  // namespace

std::vector<std::optional<Forecast>> forecast(const PreparedStudy& prepared) {
    std::vector<std::optional<Forecast>> forecasts(prepared.cases().size());
    for (std::size_t i = 0; i < forecasts.size(); ++i) {
        try {
            forecasts[i] = forecast_case(prepared, i);
        } catch (const std::exception&) {  // the row will contain the reason
        }
    }
    return forecasts;
}

std::string forecast_text(const PreparedStudy& prepared,
                          const std::vector<std::optional<Forecast>>& forecasts) {
    TextTable table;
    table.columns = {{"case"},     {"structure", Align::left}, {"sources"}, {"about s"},
                     {"about MB"}, {"setting", Align::left}};
    double seconds = 0;
    double most_bytes = 0;
    std::size_t unknown = 0;
    for (std::size_t i = 0; i < forecasts.size(); ++i) {
        const Case& c = prepared.cases()[i];
        const auto& f = forecasts[i];
        table.rows.push_back({fmt::format("{}", i + 1), structure_label(c),
                              fmt::format("{}", prepared.source_counts()[i]),
                              f ? fmt::format("{:.2g}", f->seconds) : "–",
                              f ? fmt::format("{:.3g}", 1e-6 * f->bytes) : "–", setting_label(c)});
        seconds += f ? f->seconds : 0;
        most_bytes = std::max(most_bytes, f ? f->bytes : 0);
        unknown += f ? 0 : 1;
    }
    std::string text = render(table);
    if (unknown == forecasts.size()) {
        return text +
               fmt::format("\n{}: no trial predicts the cost (–)\n", counted(unknown, "case"));
    }
    text +=
        fmt::format("\n{}: about {} in all, structures of up to {:.2g} MB",
                    counted(forecasts.size(), "case"), duration_text(seconds), 1e-6 * most_bytes);
    if (unknown > 0) text += fmt::format("; {} of them (–) not counted", unknown);
    return text + "\n";
}

}  // namespace controlspace
