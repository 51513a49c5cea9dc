#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "controlspace/space/control_space.h"
#include "controlspace/space/space_options.h"

namespace controlspace {

/// One structure of the study.
struct CatalogueEntry {
    std::string id;                ///< as in options and result files: "K_L", "uniform-nearest"
    std::string description;       ///< one line
    bool has_split_rules = false;  ///< a kd-tree: to be run with each SplitRule
    bool exact_at_nodes = true;    ///< answers a control node's own metric at its position
    int order = 0;                 ///< of interpolation: 0 constant, 1 linear, 2 quadratic
    std::unique_ptr<ControlSpace> (*construct)(const SpaceOptions&) = nullptr;
    /// How it is chosen with others: "trees" (the paper's), "anchored", "baselines".
    std::string group = "baselines";
    /// Holds metrics, so that assign() sets them; otherwise sources, and assign() is refused.
    bool takes_metrics = true;
    /// Answers the cones of its sources at once, without gradation, and its nodes are the sources.
    bool graded_from_start = false;
    bool has_voxels = false;     ///< a grid, made finer by SpaceOptions::voxel
    bool has_levels = false;     ///< a grid of voxels of many sizes: SpaceOptions::voxel_factor
    bool can_prune = false;      ///< joins voxels that are alike: SpaceOptions::prune_delta
    bool can_freeze = false;     ///< has forms that are only read: ControlSpace::freeze
    double rounding = 1e-12;     ///< δ up to which it answers metrics that it was given
    std::string former_id = {};  ///< still understood in options and study files

    /// A new structure. Throws InputError where options are invalid.
    std::unique_ptr<ControlSpace> make(const SpaceOptions& options) const;
};

/// The entry that is named `id`, or once was; null where there is none.
const CatalogueEntry* find_entry(std::span<const CatalogueEntry> entries, std::string_view id);

/// The six trees of the paper.
std::span<const CatalogueEntry> tree_catalogue();

/// Trees whose leaves keep sources in place of metrics.
std::span<const CatalogueEntry> anchored_catalogue();

}  // namespace controlspace
