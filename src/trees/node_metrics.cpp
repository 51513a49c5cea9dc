// SPDX-License-Identifier: Apache-2.0
#include "controlspace/trees/node_metrics.h"

#include <algorithm>
#include <utility>

#include "controlspace/metric/intersection.h"
#include "controlspace/trees/detail/make_room.h"

namespace controlspace {

void NodeMetrics::repeat(std::size_t node, std::size_t times) {
    const auto append_copies = [&](std::vector<Metric>& metrics) {
        const Metric copied = metrics[node];
        make_room(metrics, times);
        metrics.insert(metrics.end(), times, copied);
    };
    append_copies(field_);
    if (keeps_requested()) append_copies(requested_);
}

void NodeMetrics::append(const Metric& requested, const Metric& field) {
    const auto append_one = [](std::vector<Metric>& metrics, const Metric& m) {
        make_room(metrics, 1);
        metrics.push_back(m);
    };
    append_one(field_, field);
    if (keeps_requested()) append_one(requested_, requested);
}

void NodeMetrics::grow(std::size_t nodes) {
    make_room(field_, nodes);
    field_.resize(field_.size() + nodes);
}

void NodeMetrics::lower(std::size_t node, const Metric& m) {
    field_[node] = intersection(field_[node], m);
    if (!keeps_requested()) return;
    requested_[node] = intersection(requested_[node], m);
    requests_isotropic_ = requests_isotropic_ && is_isotropic(requested_[node]);
}

void NodeMetrics::scale(std::size_t node, double factor) {
    field_[node] = factor * field_[node];
    if (keeps_requested()) requested_[node] = factor * requested_[node];
}

std::vector<Metric> NodeMetrics::release_requested() {
    if (keeps_requested()) field_ = std::exchange(requested_, {});
    return field_;
}

void NodeMetrics::keep_requested(std::vector<Metric> requested) {
    requested_ = std::move(requested);
    requested_.reserve(field_.capacity());  // both grow together
    requests_isotropic_ = std::all_of(requested_.begin(), requested_.end(), is_isotropic);
}

void NodeMetrics::require_sound(const StateReader& state, std::size_t nodes) const {
    state.require(field_.size() == nodes, "nodes.field", "has another number of nodes");
    state.require(!keeps_requested() || requested_.size() == nodes, "nodes.requested",
                  "has another number of nodes");
    require_metrics(state, "nodes.field", field_);
    require_metrics(state, "nodes.requested", requested_);
}

void NodeMetrics::describe(Footprint& footprint) const {
    footprint.control_nodes = field_.size();
    footprint.bytes_payload = field_.capacity() * sizeof(Metric);
    footprint.bytes_auxiliary += requested_.capacity() * sizeof(Metric);
}

void NodeMetrics::shrink_to_fit() {
    controlspace::shrink_to_fit(field_);
    controlspace::shrink_to_fit(requested_);
}

}  // namespace controlspace
