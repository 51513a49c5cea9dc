#include "trees/values/node_metrics.h"

#include <algorithm>
#include <utility>

#include "controlspace/metric/intersection.h"
#include "trees/topology/make_room.h"

namespace controlspace {

void NodeMetrics::repeat(std::size_t node, std::size_t times) {
    const auto append_copies = [&](std::vector<Metric>& metrics) {
        const Metric copied = metrics[node];
        make_room(metrics, times);
        metrics.insert(metrics.end(), times, copied);
    };
    append_copies(field_);
    if (keeps_asked()) append_copies(asked_);
}

void NodeMetrics::append(const Metric& asked, const Metric& field) {
    const auto append_one = [](std::vector<Metric>& metrics, const Metric& m) {
        make_room(metrics, 1);
        metrics.push_back(m);
    };
    append_one(field_, field);
    if (keeps_asked()) append_one(asked_, asked);
}

void NodeMetrics::grow(std::size_t nodes) {
    make_room(field_, nodes);
    field_.resize(field_.size() + nodes);
}

void NodeMetrics::lower(std::size_t node, const Metric& m) {
    field_[node] = intersection(field_[node], m);
    if (!keeps_asked()) return;
    asked_[node] = intersection(asked_[node], m);
    asks_isotropic_ = asks_isotropic_ && is_isotropic(asked_[node]);
}

std::vector<Metric> NodeMetrics::release_asked() {
    if (keeps_asked()) field_ = std::exchange(asked_, {});
    return field_;
}

void NodeMetrics::keep_asked(std::vector<Metric> asked) {
    asked_ = std::move(asked);
    asked_.reserve(field_.capacity());  // both grow together
    asks_isotropic_ = std::all_of(asked_.begin(), asked_.end(), is_isotropic);
}

void NodeMetrics::require_sound(const StateReader& state, std::size_t nodes) const {
    state.require(field_.size() == nodes, "nodes.field", "has another number of nodes");
    state.require(!keeps_asked() || asked_.size() == nodes, "nodes.asked",
                  "has another number of nodes");
    require_metrics(state, "nodes.field", field_);
    require_metrics(state, "nodes.asked", asked_);
}

void NodeMetrics::describe(Footprint& footprint) const {
    footprint.control_nodes = field_.size();
    footprint.bytes_payload = field_.capacity() * sizeof(Metric);
    footprint.bytes_auxiliary += asked_.capacity() * sizeof(Metric);
}

void NodeMetrics::shrink_to_fit() {
    controlspace::shrink_to_fit(field_);
    controlspace::shrink_to_fit(asked_);
}

}  // namespace controlspace
