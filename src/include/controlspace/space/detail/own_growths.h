#pragma once

#include <cstddef>
#include <string_view>
#include <vector>

#include "controlspace/sources/point_source.h"
#include "controlspace/space/detail/state.h"

namespace controlspace {

/// `growth` of sources in a flat array, which is empty as long as all are 0.
class OwnGrowths {
public:
    /// Of the source `i`, which comes after all that were added.
    void add(std::size_t i, double growth) {
        if (growth == 0 && values_.empty()) return;
        values_.resize(i, 0);
        values_.push_back(growth);
    }
    bool empty() const { return values_.empty(); }
    double operator[](std::size_t i) const { return i < values_.size() ? values_[i] : 0; }
    std::size_t bytes() const { return values_.capacity() * sizeof(double); }
    void shrink_to_fit() { values_.shrink_to_fit(); }

    void save(StateWriter& state, std::string_view name) const {
        if (!empty()) state(name, values_);
    }
    /// Of so many sources. Throws InputError where they are not sound.
    void load(const StateReader& state, std::string_view name, std::size_t sources) {
        values_.clear();
        if (!state.has(name)) return;
        state(name, values_);
        state.require(values_.size() == sources, name, "has another length than the sources");
        state.require(all_are(values_, is_source_growth), name, "holds what is no ratio");
    }

private:
    std::vector<double> values_;
};

}  // namespace controlspace
