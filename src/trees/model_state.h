// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "controlspace/trees/leaf_model.h"
#include "space/state.h"
#include "trees/topology/topology.h"

namespace controlspace {

/// Visits the arrays of a model without a change.
void read_arrays(const CellModel& model, LeafArrays& visitor);

/// Writes the metrics of all nodes and the arrays of a model.
void save_model(const CellModel& model, const NodeMetrics& metrics, StateWriter& state);

/// Reads what save_model has written for a tree. Throws InputError where it is not sound.
template <class Node>
void load_model(LeafModel<Node>& model, const Topology<Node>& tree, const StateReader& state);

/// Throws InputError unless each array has an entry for each of so many leaves, and its numbers are
/// finite.
void require_sound_arrays(const CellModel& model, std::size_t leaves, const StateReader& state);

/// Gives the entries of arrays to leaves that were numbered anew; leaf i was `former[i]`.
void reorder_arrays(CellModel& model, const std::vector<LeafIndex>& former);

}  // namespace controlspace
