// SPDX-License-Identifier: Apache-2.0
#include "controlspace/trees/node_metrics.h"

#include "controlspace/metric/intersection.h"
#include "space/state.h"
#include "trees/make_room.h"

namespace controlspace {

void NodeMetrics::repeat(std::size_t node, std::size_t times) {
    const Metric copied = field_[node];
    make_room(field_, times);
    field_.insert(field_.end(), times, copied);
}

void NodeMetrics::append(const Metric& m) {
    make_room(field_, 1);
    field_.push_back(m);
}

void NodeMetrics::grow(std::size_t nodes) {
    make_room(field_, nodes);
    field_.resize(field_.size() + nodes);
}

void NodeMetrics::lower(std::size_t node, const Metric& m) {
    field_[node] = intersection(field_[node], m);
}

void NodeMetrics::scale(std::size_t node, double factor) { field_[node] = factor * field_[node]; }

void NodeMetrics::require_sound(const StateReader& state, std::size_t nodes) const {
    state.require(field_.size() == nodes, "nodes.field", "has another number of nodes");
    require_metrics(state, "nodes.field", field_);
}

void NodeMetrics::describe(Footprint& footprint) const {
    footprint.control_nodes = field_.size();
    footprint.bytes_payload = field_.capacity() * sizeof(Metric);
}

void NodeMetrics::shrink_to_fit() { controlspace::shrink_to_fit(field_); }

}  // namespace controlspace
