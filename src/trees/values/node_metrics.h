#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "controlspace/metric/metric.h"
#include "controlspace/space/control_space.h"
#include "space/state.h"

namespace controlspace {

/// Metrics of the control nodes of a structure: the field, which gradation makes smaller, and where
/// sources are to come after gradation (SpaceOptions::takes_later_sources), once it is graded, also
/// what the sources alone ask for.
class NodeMetrics {
public:
    NodeMetrics(std::size_t nodes, const Metric& metric) : field_(nodes, metric) {}

    std::size_t size() const { return field_.size(); }
    const Metric& operator[](std::size_t node) const { return field_[node]; }
    [[gnu::always_inline]] void prefetch(std::size_t node) const {
        __builtin_prefetch(&field_[node]);
    }
    std::span<const Metric> field() const { return field_; }
    std::span<Metric> field() { return field_; }
    /// What the sources alone ask for: the same as the field unless that is kept apart.
    std::span<const Metric> asked() const { return keeps_asked() ? asked_ : field_; }
    bool keeps_asked() const { return !asked_.empty(); }
    /// Whether all that is asked for is isotropic; meaningless unless it is kept apart.
    bool asks_isotropic() const { return asks_isotropic_; }

    /// Appends `times` copies of a node.
    void repeat(std::size_t node, std::size_t times);
    void append(const Metric& asked, const Metric& field);
    /// Appends so many nodes, which are to be set; for a field that is what is asked for.
    void grow(std::size_t nodes);
    /// Intersects what is asked for, and so the field, with `m`.
    void lower(std::size_t node, const Metric& m);
    /// Sets the field alone.
    void set(std::size_t node, const Metric& m) { field_[node] = m; }

    /// Makes the field what is asked for, kept apart no longer, and returns a copy of it.
    std::vector<Metric> release_asked();
    /// Keeps what was asked for before the field was graded.
    void keep_asked(std::vector<Metric> asked);
    /// From now on the field is what is asked for.
    void forget_asked() { asked_.clear(); }

    template <class Self, class State>
    static void exchange(Self& self, State& state) {
        state("nodes.field", self.field_);
        state("nodes.asked", self.asked_);
        state("nodes.asks_isotropic", self.asks_isotropic_);
    }
    /// Throws InputError unless what was loaded are metrics, of so many nodes.
    void require_sound(const StateReader& state, std::size_t nodes) const;

    void describe(Footprint& footprint) const;
    void shrink_to_fit();

private:
    std::vector<Metric> field_;
    std::vector<Metric> asked_;  // empty unless kept apart
    bool asks_isotropic_ = false;
};

}  // namespace controlspace
