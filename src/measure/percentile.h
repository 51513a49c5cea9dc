#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace controlspace {

/// The least of `values` that at least `percent` per cent of them do not exceed (nearest rank).
/// Reorders them; there must be one.
inline double percentile(std::vector<double>& values, std::size_t percent) {
    const std::size_t rank = (values.size() * percent + 99) / 100;
    const auto nth = values.begin() + static_cast<std::ptrdiff_t>(rank - 1);
    std::nth_element(values.begin(), nth, values.end());
    return *nth;
}

}  // namespace controlspace
