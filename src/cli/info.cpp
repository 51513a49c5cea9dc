// SPDX-License-Identifier: Apache-2.0
// The command `info`: describes a file of sources, or a control space.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <memory>

#include "cli/command.h"
#include "cli/filled_space.h"
#include "cli/formats.h"
#include "cli/input_study.h"
#include "cli/options.h"
#include "cli/progress.h"
#include "cli/standard_output.h"
#include "controlspace/baselines/catalogue.h"
#include "controlspace/gradation/grade.h"
#include "controlspace/measure/reference.h"
#include "controlspace/space/control_space_file.h"
#include "controlspace/space/sample_parallel.h"
#include "controlspace/space/split_words.h"
#include "controlspace/trees/octree_pieces.h"
#include "io/text/metric_rows.h"
#include "measure/source_summary.h"

namespace controlspace {
namespace {

std::string lengths_text(const LengthSummary& s) {
    return fmt::format(
        "  isotropic    {} of them\n"
        "  lengths      {:.6g} to {:.6g}, mean {:.6g}\n"
        "  anisotropy   {:.4g} (largest)\n",
        s.isotropic, s.finest, s.coarsest, s.mean, s.anisotropy);
}

std::string sources_info(const SourceSummary& s) {
    std::string text =
        fmt::format("  sources      {}, all positive definite\n  extent       {}\n{}", s.count,
                    to_string(s.extent), lengths_text(s));
    text += fmt::format(
        "  gradation    {:.4g} (largest g_r of the cone law, over the six nearest of each "
        "source)\n",
        s.gradation);
    if (s.own_growths > 0) {
        text +=
            fmt::format("  growth       {} sources have gradation ratios of their own, {} to {}\n",
                        s.own_growths, s.least_growth, s.most_growth);
    }
    if (s.contradictory > 0) {
        text += fmt::format("  conflicts    {} sources share their position with a different one\n",
                            s.contradictory);
    }
    return text;
}

/// By which factors the exact field of sources is longer than walls ask for.
std::vector<double> wall_factors(const std::vector<PointSource>& sources,
                                 const std::vector<WallRequest>& walls) {
    std::vector<Point> positions, places;
    for (const PointSource& s : sources) positions.push_back(s.position);
    for (const WallRequest& wall : walls) places.push_back(wall.place);
    const auto field = exact_reference(columns_of(sources), Case{}.g_r,
                                       largest_metric(bounding_box(positions, 0)));
    const std::vector<Metric> metrics = sample_parallel(*field, places);
    std::vector<double> factors;
    for (std::size_t i = 0; i < walls.size(); ++i) {
        factors.push_back(1 / (metric_length(metrics[i], walls[i].normal) * walls[i].length));
    }
    return factors;
}

/// Of files that are parts.
std::string parts_info(const std::filesystem::path& input, const GivenSettings& settings,
                       const std::vector<PointSource>& sources) {
    constexpr std::size_t rays = 10000;
    constexpr double far = 1.5;  // beyond what gradation adds between sources
    Study study;
    apply(settings, study_parameters(), study);
    std::string text;
    for (const std::filesystem::path& file : files_named(input)) {
        if (!is_part(file)) continue;
        const auto [triangles, edges, unit, walls] =
            facts_of_part(file, study.sources.in_file, rays);
        if (!unit.empty()) {
            text += fmt::format("  unit         {} in the file, {} here\n", unit,
                                name_of(study.sources.in_file.unit.value_or(LengthUnit::mm)));
        }
        text += fmt::format("  surface      {} triangles, {}\n", triangles,
                            edges.open.empty() ? "closed"
                                               : fmt::format("{} of {} edges open",
                                                             edges.open.size(), edges.count));
        text += fmt::format("  walls        behind {} of {} random places of the faces",
                            walls.size(), rays);
        if (!walls.empty()) {
            const std::vector<double> factors = wall_factors(sources, walls);
            const auto worst = std::ranges::max_element(factors);
            const Point& at = walls[static_cast<std::size_t>(worst - factors.begin())].place;
            text += fmt::format(
                "; the exact field (g_r {}) is up to {:.3g}x as long as they ask, at ({:.6g}, "
                "{:.6g}, {:.6g}); more than {}x at {}",
                Case{}.g_r, *worst, at.x(), at.y(), at.z(), far,
                std::ranges::count_if(factors, [](double factor) { return factor > far; }));
        }
        text += '\n';
    }
    return text;
}

/// Where some tensors are invalid, others may be misread: their range shows it.
std::string indefinite_info(const IndefiniteTensors& tensors) {
    constexpr std::size_t shown = 5;
    const auto& wrong = tensors.indefinite();
    const LengthSummary definite = summarise_lengths(tensors.definite());
    const std::size_t all = definite.count + wrong.size();
    const auto first = wrong.begin() + static_cast<std::ptrdiff_t>(std::min(shown, wrong.size()));
    std::string text = fmt::format(
        "  sources      {}, {} of them ({:.4g} %) positive definite; not so: {}{}\n  refused      "
        "by other commands: {}\n",
        all, definite.count, 100 * static_cast<double>(definite.count) / static_cast<double>(all),
        fmt::join(wrong.begin(), first, ", "), wrong.size() > shown ? ", ..." : "", tensors.what());
    if (definite.count > 0) text += lengths_text(definite);
    return text;
}

double mb(std::size_t bytes) { return static_cast<double>(bytes) / 1e6; }

/// The options that this structure uses, under the names that `build` has for them.
std::string options_text(const CatalogueEntry& entry, const SpaceOptions& o) {
    const bool is_tree = entry.has<SourceLeaves>();
    std::string text;
    const auto add = [&](std::string_view name, const auto& value) {
        text += fmt::format("{}{} {}", text.empty() ? "" : ", ", name, value);
    };
    if (entry.has<SplitRules>()) add("split", name_of(o.split));
    if (is_tree || o.voxel == 0) add("tau", o.l_min);
    add("epsilon", o.tolerance);
    const auto depth = entry.has<SplitRules>() ? o.kd_depth : o.octree_depth;
    if (is_tree && depth) add("maximum depth", *depth);
    if (entry.has<QuadraticLeaves>()) add("interpolation", name_of(o.quadratic_form));
    if (entry.has<KeptSources>()) {
        add("intersection", name_of(o.intersection));
        add("g_r", o.ratio);
    }
    if (entry.has<VoxelSize>() && o.voxel > 0) add("voxel", o.voxel);
    if (entry.has<Pruning>()) add("prune_delta", o.prune_delta);
    if (o.takes_later_sources) text += ", accepts later sources";
    return text;
}

/// Parts and memory.
std::string footprint_info(const Footprint& footprint) {
    std::string text = fmt::format("  cells        {}", footprint.cells);
    if (footprint.tree_nodes > 0) {
        text += fmt::format(" leaves of {} tree nodes, at levels of up to {}", footprint.tree_nodes,
                            footprint.depth);
    }
    if (!footprint.remark.empty()) text += "; " + footprint.remark;
    return text +
           fmt::format(
               "\n  memory       {:.3g} MB: metrics {:.3g}, topology {:.3g}, auxiliary {:.3g}",
               mb(footprint.bytes_total()), mb(footprint.bytes_payload),
               mb(footprint.bytes_topology), mb(footprint.bytes_auxiliary));
}

std::string pieces_info(const std::filesystem::path& index) {
    const auto space = load_octree_pieces(index, structures());
    return fmt::format("  structure    an octree in pieces, read-only\n  domain       {}\n{}\n",
                       to_string(space->domain()), footprint_info(space->footprint()));
}

/// Structure and options, parts and memory, and the range of the control nodes' metrics.
std::string space_info(const std::filesystem::path& file) {
    const SavedControlSpace saved = open_control_space(file, structures());
    const Recipe& recipe = saved.recipe;
    const CatalogueEntry& entry = *find_entry(structures(), recipe.structure);
    std::string text = fmt::format("  structure    {}: {}\n", entry.id, entry.description);
    if (recipe.precision) {
        text +=
            fmt::format("  precision    {}: read-only\n", name_of(stored_in(*recipe.precision)));
    }
    text += fmt::format("  saved by     {}\n  domain       {}\n  options      {}\n", saved.saved_by,
                        to_string(saved.space->domain()), options_text(entry, recipe.options));
    text +=
        fmt::format("{}{}\n", footprint_info(saved.space->footprint()), size_of_file(file, "; "));
    const auto nodes = control_nodes(*saved.space, Neighbourhood::faces);
    if (!nodes) return text;
    const LengthSummary lengths = summarise_lengths(nodes->metrics);
    text += fmt::format("  nodes        {} control nodes\n", lengths.count);
    return text + lengths_text(lengths) +
           fmt::format("  gradation    {:.4g} (largest g_r of the cone law, over neighbours)\n",
                       largest_gradation(nodes->graph, nodes->metrics, GradationLaw::cone));
}

std::string info_text(const std::filesystem::path& input, const GivenSettings& settings) {
    if (is_control_space(input)) {
        require_no_settings(input, settings);
        return is_in_pieces(input) ? pieces_info(input) : space_info(input);
    }
    try {
        const std::vector<PointSource> sources = sources_of_input(input, settings);
        return sources_info(summarise(sources)) + parts_info(input, settings, sources);
    } catch (const IndefiniteTensors& tensors) {
        return indefinite_info(tensors);
    }
}

}  // namespace

Action add_info(Options& options) {
    const auto job = std::make_shared<Job>(Job{.output = "/dev/stdout"});
    options.add({"FILE", "FILE",
                 source_formats_help() + "; or a saved control space (.ctrl, .pctrl)", "", true},
                job->input);
    options.add({"-o,--output", "FILE", "File to write; left out: standard output"}, job->output);
    add_reading_options(options, *job);
    options.set_statuses(
        "Exit status:\n"
        "  0    the file was read; tensors that are not positive definite are counted\n"
        "  1    the program or the system failed\n"
        "  2    the file cannot be read, or a setting does not fit");
    return [job](const std::string&) {
        require_output(job->output, files_named(job->input));
        std::string text;
        {
            StepProgress progress(job->quiet, job->output);
            progress.started("reading");
            text = info_text(job->input, given_settings(job->given));
        }
        print_to(job->output, job->input.string() + "\n" + text);
        return 0;
    };
}

}  // namespace controlspace
