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
/// other: where hill climbs start.
class Peaks {
public:
    struct Peak {
        double delta = 0;
        Point where = Point::Zero();
    };
    static constexpr std::size_t most = 6;

    explicit Peaks(const Box& leaf) : apart_(0.1 * leaf.edges()) {}

    void enter(double delta, const Point& x) {
        const auto end = peaks_.begin() + static_cast<std::ptrdiff_t>(count_);
        auto place = std::find_if(peaks_.begin(), end, [&](const Peak& peak) {
            return ((peak.where - x).cwiseAbs().array() <= apart_.array()).all();
        });
        if (place == end && count_ < most) {
            peaks_[count_++] = {delta, x};
            return;
        }
        if (place == end) place = std::ranges::min_element(peaks_, {}, &Peak::delta);
        if (delta > place->delta) *place = {delta, x};
    }
    /// The worst first.
    std::span<const Peak> sorted() {
        const std::span<Peak> all(peaks_.data(), count_);
        std::ranges::stable_sort(all, std::ranges::greater(), &Peak::delta);
        return all;
    }

private:
    Vector apart_;
    std::array<Peak, most> peaks_{};
    std::size_t count_ = 0;
};

}  // namespace controlspace
