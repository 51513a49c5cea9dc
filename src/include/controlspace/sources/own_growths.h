// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

namespace controlspace {

/// `growth` of sources in a flat array, which is empty as long as all are 0.
class OwnGrowths {
public:
    OwnGrowths() = default;
    explicit OwnGrowths(std::vector<double> values) : values_(std::move(values)) {}

    /// Of the source `i`, which comes after all that were added.
    void add(std::size_t i, double growth) {
        if (growth == 0 && values_.empty()) return;
        values_.resize(i, 0);
        values_.push_back(growth);
    }
    bool empty() const { return values_.empty(); }
    double operator[](std::size_t i) const { return i < values_.size() ? values_[i] : 0; }
    const std::vector<double>& values() const { return values_; }
    std::size_t bytes() const { return values_.capacity() * sizeof(double); }
    void shrink_to_fit() { values_.shrink_to_fit(); }

private:
    std::vector<double> values_;
};

}  // namespace controlspace
