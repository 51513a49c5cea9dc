// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "geometry/large_pages.h"

namespace controlspace {

/// Makes room for `more` elements. An array that is full gets a quarter longer, where the standard
/// library doubles it: while it grows, the old one and the new one are there together.
template <class T>
void make_room(std::vector<T>& array, std::size_t more) {
    const std::size_t needed = array.size() + more;
    if (needed > array.capacity()) {
        reallocate(array, std::max(needed, array.capacity() + array.capacity() / 4));
    }
}

/// Gives back what an array that grew has too much.
template <class T>
void shrink_to_fit(std::vector<T>& array) {
    if (array.capacity() > array.size()) reallocate(array, array.size());
}

}  // namespace controlspace
