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

/// Metrics of the control nodes of a structure: the field, which gradation makes smaller; and,
/// where sources may come after gradation (SpaceOptions::takes_later_sources), from the first
/// gradation on also what the sources alone request.
class NodeMetrics {
public:
    NodeMetrics(std::size_t nodes, const Metric& metric) : field_(nodes, metric) {}
    explicit NodeMetrics(std::vector<Metric> field) : field_(std::move(field)) {}

    std::size_t size() const { return field_.size(); }
    const Metric& operator[](std::size_t node) const { return field_[node]; }
    std::span<const Metric> field() const { return field_; }
    std::span<Metric> field() { return field_; }
    NodeView<Metric> values() const { return {field_}; }
    /// What the sources alone request: the field unless that is kept apart.
    std::span<const Metric> requested() const { return keeps_requested() ? requested_ : field_; }
    NodeView<Metric> requested_values() const { return {requested(), true}; }
    bool keeps_requested() const { return !requested_.empty(); }
    /// Whether all that is requested is isotropic; meaningless unless it is kept apart.
    bool requests_isotropic() const { return requests_isotropic_; }

    /// Appends `times` copies of a node.
    void repeat(std::size_t node, std::size_t times);
    void append(const Metric& requested, const Metric& field);
    /// Appends so many nodes, which are to be set; for a field that is what is requested.
    void grow(std::size_t nodes);
    /// Intersects what is requested, and so the field, with `m`.
    void lower(std::size_t node, const Metric& m);
    /// Multiplies all lengths of a node, requested ones too.
    void scale(std::size_t node, double factor);
    /// Sets the field alone.
    void set(std::size_t node, const Metric& m) { field_[node] = m; }

    /// Makes the field what is requested, kept apart no longer, and returns a copy of it.
    std::vector<Metric> release_requested();
    /// Keeps what was requested before the field was graded.
    void keep_requested(std::vector<Metric> requested);
    /// From now on the field is what is requested.
    void forget_requested() { requested_.clear(); }

    template <class Self, class State>
    static void exchange(Self&& self, State& state) {
        state("nodes.field", self.field_);
        state("nodes.requested", self.requested_);
        state("nodes.requests_isotropic", self.requests_isotropic_);
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
    std::vector<Metric> requested_;  // empty unless kept apart
    bool requests_isotropic_ = false;
};

}  // namespace controlspace
