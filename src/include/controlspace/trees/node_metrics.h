// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "controlspace/metric/metric.h"
#include "controlspace/metric/stored_metric.h"
#include "controlspace/space/control_space.h"
#include "controlspace/space/detail/state.h"

namespace controlspace {

/// Metrics of control nodes by their numbers, of which a storage makes the value at a point: the
/// field's, or the requested ones. `M` is Metric, or in compact forms what converts to it.
template <class M>
struct NodeView {
    std::span<const typename Packing<M>::Item> metrics;
    bool are_requested = false;  ///< by the sources, before gradation
    [[no_unique_address]] Packing<M> packing = {};

    decltype(auto) operator[](std::size_t node) const { return packing(metrics[node]); }
};

/// Metrics of the control nodes of a structure.
class NodeMetrics {
public:
    NodeMetrics(std::size_t nodes, const Metric& metric) : field_(nodes, metric) {}
    explicit NodeMetrics(std::vector<Metric> field) : field_(std::move(field)) {}

    std::size_t size() const { return field_.size(); }
    const Metric& operator[](std::size_t node) const { return field_[node]; }
    std::span<const Metric> field() const { return field_; }
    std::span<Metric> field() { return field_; }
    NodeView<Metric> values() const { return {field_}; }
    /// As insertion compares sources with.
    NodeView<Metric> requested_values() const { return {field_, true}; }

    /// Appends `times` copies of a node.
    void repeat(std::size_t node, std::size_t times);
    void append(const Metric& m);
    /// Appends so many nodes, which are to be set.
    void grow(std::size_t nodes);
    /// Intersects a node with `m`.
    void lower(std::size_t node, const Metric& m);
    /// Multiplies all lengths of a node.
    void scale(std::size_t node, double factor);
    void set(std::size_t node, const Metric& m) { field_[node] = m; }

    template <class Self, class State>
    static void exchange(Self&& self, State& state) {
        state("nodes.field", self.field_);
    }
    /// Throws InputError unless what was loaded are metrics, of so many nodes.
    void require_sound(const StateReader& state, std::size_t nodes) const;

    void describe(Footprint& footprint) const;
    void shrink_to_fit();
    [[gnu::always_inline]] void prefetch(std::size_t node) const {
        __builtin_prefetch(&field_[node]);
    }

private:
    std::vector<Metric> field_;
};

}  // namespace controlspace
