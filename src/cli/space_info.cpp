#include "cli/space_info.h"

#include <fmt/format.h>

#include "cli/info.h"
#include "controlspace/baselines/catalogue.h"
#include "controlspace/gradation/grade.h"
#include "controlspace/space/control_space_file.h"
#include "study/names.h"

namespace controlspace {
namespace {

double mb(std::size_t bytes) { return static_cast<double>(bytes) / 1e6; }

const CatalogueEntry& entry_of(const Making& making) {
    return *find_entry(structures(), making.structure);
}

/// Those that this structure heeds, by the names that `build` has for them.
std::string options_text(const CatalogueEntry& entry, const SpaceOptions& o) {
    const bool is_tree = entry.group == "trees" || entry.group == "anchored";
    std::string text;
    const auto add = [&](std::string_view name, const auto& value) {
        text += fmt::format("{}{} {}", text.empty() ? "" : ", ", name, value);
    };
    if (entry.has_split_rules) add("split", name_of(o.split));
    if (is_tree || entry.has_levels || o.voxel == 0) add("tau", o.l_min);
    add("epsilon", o.tolerance);
    if (is_tree) add("depth at most", entry.has_split_rules ? o.kd_depth : o.octree_depth);
    if (!entry.takes_metrics) add("g_r", o.ratio);
    if (entry.has_voxels && o.voxel > 0) add("voxel", o.voxel);
    if (entry.has_levels) add("voxel_factor", o.voxel_factor);
    if (entry.can_prune) add("prune_delta", o.prune_delta);
    if (o.takes_later_sources) text += ", takes later sources";
    return text;
}

}  // namespace

std::string space_info(const std::filesystem::path& file) {
    const auto space = load_control_space(file, structures());
    const Making& making = *space->making();
    const CatalogueEntry& entry = entry_of(making);
    const Footprint footprint = space->footprint();
    std::string text =
        fmt::format("{}\n  structure    {}: {}\n", file.string(), entry.id, entry.description);
    if (making.frozen) {
        text += fmt::format("  frozen       in {}: it is only read\n",
                            *making.frozen == Precision::floats ? "floats" : "doubles");
    }
    text +=
        fmt::format("  saved by     {}\n  domain       {}\n  options      {}\n", making.saved_by,
                    to_string(space->domain()), options_text(entry, making.options));
    text += fmt::format("  elements     {}", footprint.elements);
    if (footprint.leaves > 0) {
        text += fmt::format(", {} of them leaves, in {} levels", footprint.leaves, footprint.depth);
    }
    if (!footprint.remark.empty()) text += "; " + footprint.remark;
    text += fmt::format(
        "\n  memory       {:.3g} MB: {:.3g} of metrics, {:.3g} to find them, {:.3g} beside; {:.3g} "
        "MB in the file\n",
        mb(footprint.bytes_total()), mb(footprint.bytes_payload), mb(footprint.bytes_topology),
        mb(footprint.bytes_auxiliary), mb(std::filesystem::file_size(file)));
    const ControlNodes nodes = space->control_nodes(Neighbourhood::faces);
    const LengthSummary lengths = summarise_lengths(nodes.metrics);
    text += fmt::format("  nodes        {} that carry metrics\n", lengths.count);
    return text + lengths_text(lengths) +
           fmt::format("  gradation    {:.4g} at most, between neighbours (g_r of the cone law)\n",
                       largest_gradation(nodes.graph, nodes.metrics, GradationLaw::cone));
}

}  // namespace controlspace
