// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "controlspace/metric/metric.h"
#include "controlspace/space/control_space.h"

namespace controlspace {

class StateReader;

/// Metrics of the control nodes of a structure.
class NodeMetrics {
public:
    NodeMetrics(std::size_t nodes, const Metric& metric) : field_(nodes, metric) {}
    explicit NodeMetrics(std::vector<Metric> field) : field_(std::move(field)) {}

    std::size_t size() const { return field_.size(); }
    const Metric& operator[](std::size_t node) const { return field_[node]; }
    std::span<const Metric> field() const { return field_; }
    std::span<Metric> field() { return field_; }

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
