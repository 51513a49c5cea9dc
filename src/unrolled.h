// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <type_traits>
#include <utility>

namespace controlspace {

/// Calls visit(0), ..., visit(n - 1) with constants, which vectors need.
template <std::size_t n, class Visit>
[[gnu::always_inline]] inline void unrolled(const Visit& visit) {
    [&]<std::size_t... i>(std::index_sequence<i...>) __attribute__((always_inline)) {
        (visit(std::integral_constant<std::size_t, i>()), ...);
    }
    (std::make_index_sequence<n>());
}

}  // namespace controlspace
