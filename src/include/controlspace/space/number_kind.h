// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <type_traits>

#include "controlspace/geometry/box.h"
#include "controlspace/metric/metric.h"

namespace controlspace {

/// What numbers an array in a file consists of.
enum class NumberKind : std::uint32_t { bytes = 1, words = 2, counts = 3, reals = 4 };

/// Of which numbers a `T` consists, without gaps.
template <class T>
constexpr NumberKind number_kind() {
    if constexpr (std::is_same_v<T, std::uint8_t> || std::is_same_v<T, char>) {
        return NumberKind::bytes;
    } else if constexpr (std::is_same_v<T, std::uint32_t>) {
        return NumberKind::words;
    } else if constexpr (std::is_same_v<T, std::uint64_t>) {
        return NumberKind::counts;
    } else if constexpr (requires { typename T::value_type; } &&
                         !std::is_same_v<T, Point>) {  // std::array
        return number_kind<typename T::value_type>();
    } else {
        static_assert(std::is_same_v<T, double> || std::is_same_v<T, Metric> ||
                      std::is_same_v<T, Point> || std::is_same_v<T, Box>);
        static_assert(sizeof(Metric) == 6 * sizeof(double) && sizeof(Box) == 6 * sizeof(double));
        return NumberKind::reals;
    }
}

}  // namespace controlspace
