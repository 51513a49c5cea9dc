// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <ranges>
#include <vector>

#include "controlspace/metric/nonconformity.h"
#include "controlspace/space/control_nodes.h"
#include "controlspace/space/control_space_file.h"
#include "controlspace/study/run.h"
#include "measure/stopwatch.h"
#include "refuse.h"

namespace controlspace {
namespace {

// Sources are inserted as the array that a mesher has, and time is that of it alone; more of them
// without a copy.
constexpr std::size_t most_in_array = std::size_t{1} << 18;

/// A field is followed by adaptation; without a target only what keeps its cells can follow it.
void require_follows(const Case& c, const CatalogueEntry& entry) {
    if (c.target_delta || !entry.has<SourceLeaves>()) return;
    refuse("a continuous field is followed by adaptation: set target_delta");
}

/// δ and the factor between lengths, and how they are known.
std::string outcome_of(const AdaptationReport& report, double factor) {
    if (std::isinf(report.reached)) return "δ unknown: no bound was found";
    if (report.is_bound) {
        return fmt::format("δ <= {:.4g} everywhere: lengths within {:.4g}x", report.reached,
                           factor);
    }
    return fmt::format("δ {:.4g} at worst where sampled: lengths within {:.4g}x there",
                       report.reached, factor);
}

void add_remark(Creation& creation, const std::string& remark) {
    creation.remark.append(creation.remark.empty() ? "" : "; ").append(remark);
}

void adapt(Filled& filled, const Case& c, const Workload& workload,
           std::span<const PointSource> sources, const RowLimits& limits) {
    AdaptationGoal goal{.sources = sources,
                        .continuous = workload.field.field,
                        .ratio = c.g_r,
                        .intersection = c.intersection,
                        .h_max = c.sources.h_max,
                        .values = c.values,
                        .places = workload.field.places};
    if (c.target_delta) goal.target = *c.target_delta;
    if (c.max_leaves) goal.max_leaves = *c.max_leaves;
    if (const auto precision = precision_of(c.precision)) goal.precision = *precision;
    // Of tensors, δ allows more along one direction alone than along all at once.
    const bool is_along = has_tensors(workload);
    if (c.within && is_along) goal.target = nonconformity_along(*c.within);
    const auto factor_of = is_along ? largest_factor_along : largest_factor_within;
    const AdaptationReport report = filled.builder->adapt(goal);
    filled.creation.stopped = limits.place_of(report.stop, c.max_leaves.value_or(0));
    if (c.target_delta) {
        const double reached = factor_of(report.reached);
        add_remark(filled.creation, outcome_of(report, reached));
        if (std::isfinite(report.reached)) {
            filled.creation.within = reached;
            filled.creation.delta = report.reached;
        }
        if (report.met) return;
        filled.creation.shortfall = fmt::format(
            "target {:.4g} (lengths within {:.4g}x) missed{}{}", goal.target,
            factor_of(goal.target), report.shortfall.empty() ? "" : ": ", report.shortfall);
    }
}

void add_largest_ratio(GradationReport& gradation, const ControlSpace& space, GradationLaw law,
                       Neighbourhood neighbourhood) {
    double& left = gradation.largest_ratio_left;
    left = largest_gradation(space, neighbourhood, law).value_or(left);
}

/// On what gradation left and on settings without effect.
void remark_on_all(Creation& creation, const Study& study, const Case& c, const StudyRows& rows) {
    const auto precision = precision_of(c.precision);
    const bool is_code = precision == Precision::log16 || precision == Precision::log8;
    const double rounding = is_code ? 1e-3 : 1e-6;
    const double left = creation.gradation.largest_ratio_left;
    if (left > c.g_r * (1 + rounding)) {
        add_remark(creation, fmt::format("G left {:.4g}: lengths grow faster between nodes than "
                                         "g_r {:.4g}",
                                         left, c.g_r));
    }
    if (const auto& own = entry_of(c, rows.structures).own_precision; !own.empty()) {
        add_remark(creation, "in " + own);
    }
    const std::vector<std::string> names = settings_without_effect(study, c, rows);
    if (!names.empty()) {
        add_remark(creation, fmt::format("without effect: {}", fmt::join(names, ", ")));
    }
}

/// A grid that a cap on memory made coarser than it was to be says so in its remark.
void note_coarser(Creation& creation, const CatalogueEntry& entry, const ControlSpace& space,
                  const RowLimits& limits) {
    if (!entry.has<VoxelSize>() || space.footprint().remark.empty()) return;
    creation.stopped = limits.place_of(GrowthStop::memory);
}

// Whether the leaf of a source has an edge longer than tau in its metric.
bool has_long_leaf(const ControlSpace& space, const SourceColumns& sources, double tau) {
    const auto numbers = std::views::iota(std::size_t{0}, sources.size());
    return std::ranges::any_of(numbers, [&](std::size_t i) {
        const PointSource source = sources[i];
        const auto leaf = space.cell_at(source.position);
        return leaf && std::ranges::max(metric_edge_lengths(source.metric, leaf->edges())) > tau;
    });
}

}  // namespace

std::string RowLimits::place_of(GrowthStop stop, std::size_t max_leaves) const {
    switch (stop) {
        case GrowthStop::none:
            break;
        case GrowthStop::leaves:
            return fmt::format("at {} leaves", max_leaves);
        case GrowthStop::time:
            return "at " + time;
        case GrowthStop::memory:
            return "at " + (memory.empty() ? "max_memory" : memory);
    }
    return "";
}

/// What making a structure takes for each byte of the finished one: limits are of that. Builders
/// hold metrics in doubles, those of grids room for gradation too; leaves some 16 bytes of
/// topology.
static double bytes_while_made(const CatalogueEntry& entry, const Case& c,
                               const Workload& workload) {
    const bool is_grid = entry.has<VoxelSize>();
    const double held = is_grid ? 48 + 53 : 48 + 16;
    double number = 8;
    switch (precision_of(c.precision).value_or(Precision::doubles)) {
        case Precision::doubles:
            break;
        case Precision::floats:
            number = 4;
            break;
        case Precision::log16:
            number = 2;
            break;
        case Precision::log8:
            number = 1;
            break;
    }
    const bool is_as_made = c.precision.value_or(StoredIn::as_made) == StoredIn::as_made;
    const double numbers = is_as_made || has_tensors(workload) ? 6 : 1;
    return held / (numbers * number + (is_grid ? 0 : 16));
}

Filled make_and_fill(const Study& study, const Case& c, const StudyRows& rows,
                     const Workload& workload, const StudyObserver& observer,
                     const RowLimits& limits) {
    const CatalogueEntry& entry = entry_of(c, rows.structures);
    const bool is_adapted = c.target_delta || has_field(c.sources);
    if (is_adapted) require_follows(c, entry);
    const auto phase = [&](std::string_view name) {
        if (observer.phase_started) observer.phase_started(name);
        return Stopwatch();
    };
    Filled filled;
    Creation& creation = filled.creation;
    const auto goal_sources = is_adapted ? workload.sources.all() : std::vector<PointSource>();
    Stopwatch time = phase(is_adapted ? "adaptation" : "insertion");
    SpaceOptions options = space_options(study, c, workload, rows.parameters);
    options.growth = limits.growth;
    const double factor = bytes_while_made(entry, c, workload);
    const auto most = static_cast<double>(options.max_bytes);
    if (static_cast<double>(limits.growth.bytes) * factor < most) {
        options.growth.bytes =
            static_cast<std::size_t>(static_cast<double>(limits.growth.bytes) * factor);
        if (entry.has<VoxelSize>()) options.max_bytes = options.growth.bytes;
    }
    filled.builder = entry.make(options);
    if (is_adapted) {
        adapt(filled, c, workload, goal_sources, limits);
        filled.space = filled.builder->build({.precision = precision_of(c.precision)});
        note_coarser(creation, entry, *filled.space, limits);
        creation.insert_s = {time.seconds()};
        creation.gradation_s = {0};
        if (const auto recipe = recipe_of(*filled.space);
            recipe && c.target_delta && entry.has<VoxelSize>() && !c.voxel) {
            add_remark(creation, fmt::format("voxel {:.4g}", recipe->options.voxel));
        }
        add_largest_ratio(creation.gradation, *filled.space, GradationLaw::cone,
                          Neighbourhood::faces);
        remark_on_all(creation, study, c, rows);
        return filled;
    }
    const SourceColumns& sources = workload.sources;
    double insertion = time.seconds();
    const bool are_few = sources.size() <= most_in_array;
    const auto array = are_few ? sources.all() : std::vector<PointSource>();
    time = {};
    creation.sources_inserted =
        (are_few ? filled.builder->insert(array) : filled.builder->insert(sources)).inserted;
    insertion += time.seconds();
    creation.insert_s = {insertion};

    time = phase("gradation");
    creation.gradation = filled.builder->grade(
        {.law = c.law, .schedule = c.schedule, .ratio = c.g_r, .neighbourhood = c.neighbourhood});
    // Where grids of other systems and the search of `direct` are made.
    filled.space = filled.builder->build({.precision = precision_of(c.precision)});
    note_coarser(creation, entry, *filled.space, limits);
    creation.gradation_s = {time.seconds()};
    const ControlSpace& space = *filled.space;
    if (c.schedule == GradationSchedule::sources && entry.has<MetricNodes>()) {
        add_largest_ratio(creation.gradation, space, c.law, c.neighbourhood);
    }
    const int deepest = c.max_depth.value_or(c.split ? usual_kd_level : usual_octree_level);
    if (entry.has<SourceLeaves>() && space.footprint().depth >= deepest &&
        has_long_leaf(space, sources, c.tau)) {
        add_remark(creation, fmt::format("leaves of sources are longer than tau where level {} is "
                                         "the deepest allowed",
                                         deepest));
    }
    remark_on_all(creation, study, c, rows);
    return filled;
}

}  // namespace controlspace
