// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <functional>
#include <span>

#include "controlspace/geometry/box.h"
#include "controlspace/geometry/point.h"

namespace controlspace {

/// The places of a leaf where it departs most from the field, of those that are apart from each
/// other: where hill climbs start, or end.
class Peaks {
public:
    struct Peak {
        double delta = 0;
        Point where = Point::Zero();
    };
    static constexpr std::size_t most = 8;

    explicit Peaks(const Box& leaf) : apart_(0.2 * leaf.edges()) {}

    void enter(double delta, const Point& x) {
        const auto end = peaks_.begin() + static_cast<std::ptrdiff_t>(count_);
        auto place = std::find_if(peaks_.begin(), end,
                                  [&](const Peak& peak) { return is_within(apart_, peak, x); });
        if (place == end && count_ < most) {
            peaks_[count_++] = {delta, x};
            return;
        }
        if (place == end) place = std::ranges::min_element(peaks_, {}, &Peak::delta);
        if (delta > place->delta) *place = {delta, x};
    }
    /// Whether one that is as high is much nearer than those apart.
    bool has_beside(double delta, const Point& x) const {
        return std::any_of(peaks_.begin(), peaks_.begin() + static_cast<std::ptrdiff_t>(count_),
                           [&](const Peak& peak) {
                               return peak.delta >= delta && is_within(0.5 * apart_, peak, x);
                           });
    }
    /// The worst first.
    std::span<const Peak> sorted() {
        const std::span<Peak> all(peaks_.data(), count_);
        std::ranges::stable_sort(all, std::ranges::greater(), &Peak::delta);
        return all;
    }

private:
    static bool is_within(const Vector& reach, const Peak& peak, const Point& x) {
        return ((peak.where - x).cwiseAbs().array() <= reach.array()).all();
    }

    Vector apart_;
    std::array<Peak, most> peaks_{};
    std::size_t count_ = 0;
};

}  // namespace controlspace
