// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <variant>
#include <vector>

#include "controlspace/space/control_space_builder.h"
#include "controlspace/space/space_options.h"

namespace controlspace {

// What a structure can do, beside what all of them can. Most name the options that it reads.

/// A tree, whose leaves are cut for sources: l_min and the depth (kd_depth or octree_depth). It can
/// be adapted to a field.
struct SourceLeaves {};
/// A kd-tree, to be run with each SplitRule: split.
struct SplitRules {};
/// Control nodes carry metrics: make() gives a NodeBuilder.
struct MetricNodes {
    double rounding = 1e-12;  ///< δ up to which it answers metrics that it was given
};
/// Keeps sources and answers their cones: ratio.
struct KeptSources {};
/// Interpolates in a leaf over its neighbours: quadratic_form.
struct QuadraticLeaves {};
/// Can be built in each precision: BuildOptions::precision.
struct CompactForm {};
/// A grid: voxel.
struct VoxelSize {};
/// Can be given lengths that are fitted: AdaptationGoal::values.
struct FittedValues {};
/// Joins voxels that are alike: prune_delta.
struct Pruning {};
/// What it holds in floats can be saved to a file of OpenVDB (.vdb), too, which other programs
/// read.
struct VdbFiles {
    /// The state (control_space_file.h) in such a file, intact ones alone; `file` is for messages.
    std::string (*state_in)(const std::string& bytes, const std::string& file) = nullptr;
};

using Capability = std::variant<SourceLeaves, SplitRules, MetricNodes, KeptSources, QuadraticLeaves,
                                CompactForm, VoxelSize, FittedValues, Pruning, VdbFiles>;

/// One structure of the study.
struct CatalogueEntry {
    std::string id;           ///< as in options and result files: "K_L", "uniform-nearest"
    std::string description;  ///< one line
    /// How it is chosen together with others: "trees" (the paper's), "further" (its table's missing
    /// cell), "anchored" (leaves keep sources), "baselines".
    std::string family = "baselines";
    int order = 0;  ///< of interpolation: 0 constant in a cell, 1 linear, 2 quadratic
    std::unique_ptr<ControlSpaceBuilder> (*construct)(const SpaceOptions&) = nullptr;
    std::vector<Capability> capabilities = {};
    std::string former_id = {};  ///< still understood in options and study files
    /// Without CompactForm: the numbers that it stores, for rows of results.
    std::string own_precision = {};

    /// A builder of a new structure. Throws InputError where options are invalid.
    std::unique_ptr<ControlSpaceBuilder> make(const SpaceOptions& options) const;

    /// The capability, null if it has none of that type: `if (entry.find<VoxelSize>())`.
    template <class T>
    const T* find() const {
        for (const Capability& capability : capabilities) {
            if (const T* found = std::get_if<T>(&capability)) return found;
        }
        return nullptr;
    }
    template <class T>
    bool has() const {
        return find<T>() != nullptr;
    }
};

/// The entry that is named `id`, or once was; null where there is none.
const CatalogueEntry* find_entry(std::span<const CatalogueEntry> entries, std::string_view id);

/// Trees that hold metrics: the six of the paper, and the one that it leaves out.
std::span<const CatalogueEntry> tree_catalogue();

/// Trees whose leaves keep sources in place of metrics.
std::span<const CatalogueEntry> anchored_catalogue();

/// Both.
std::span<const CatalogueEntry> all_trees();

}  // namespace controlspace
