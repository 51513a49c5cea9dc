#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "geometry/box.h"
#include "spaces/control_space.h"
#include "spaces/split_rule.h"

namespace controlspace {

/// What a structure is made with.
struct SpaceOptions {
    Box domain;
    SplitRule split = SplitRule::middle;  ///< kd-trees only
    double l_min = 1;        ///< longest edge of a source's leaf, in the source's metric (τ)
    double tolerance = 0.2;  ///< ε_δ of insertion
    int kd_depth = 42;       ///< deepest level of a kd-tree, the root being 0
    int octree_depth = 14;   ///< deepest level of an octree, the root being 0
    double finest_length = 0;  ///< smallest length any source asks for; grids size voxels by it
    double ratio = 1.25;       ///< g_r of the gradation to come, for structures that keep sources
    std::size_t max_bytes = std::size_t{4} << 30;  ///< cap on a grid, gradation's copy included
};

/// One structure of the study.
struct CatalogueEntry {
    std::string id;                ///< as in options and result files: "K_L", "uniform-nearest"
    std::string description;       ///< one line
    bool has_split_rules = false;  ///< a kd-tree: to be run with each SplitRule
    bool exact_at_nodes = true;    ///< answers a control node's own metric at its position
    int order = 0;                 ///< of interpolation: 0 constant, 1 linear, 2 quadratic
    std::unique_ptr<ControlSpace> (*make)(const SpaceOptions&);
};

/// The six trees of the paper.
std::span<const CatalogueEntry> tree_catalogue();

/// Depths and lengths within what the structures can hold; throws InputError that names the option.
void require_valid(const SpaceOptions& options);

}  // namespace controlspace
