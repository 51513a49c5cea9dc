#pragma once

#include <span>
#include <string>

#include "baselines/openvdb/level_cells.h"
#include "baselines/openvdb/level_values.h"
#include "space/state.h"

namespace controlspace {

/// Writes the trees of a stack under names that begin with `name`: the leaves with all of their
/// values, and the tiles above them that mean something.
void save_levels(std::span<const VdbLevelTree> trees, const std::string& name, StateWriter& state);

/// Fills new trees, one for each level of `cells`, with what was saved: the same nodes and tiles.
/// Throws InputError unless the active cells fill the domain once and have metrics.
void load_levels(std::span<VdbLevelTree> trees, const std::string& name, const LevelCells& cells,
                 Interpolation interpolation, const StateReader& state);

}  // namespace controlspace
