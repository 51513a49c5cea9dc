#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace controlspace {

/// Makes room for `more` elements. An array that is full gets a quarter longer, where the standard
/// library doubles it: while it grows, the old one and the new one are there together.
template <class T>
void make_room(std::vector<T>& array, std::size_t more) {
    const std::size_t needed = array.size() + more;
    if (needed > array.capacity()) {
        array.reserve(std::max(needed, array.capacity() + array.capacity() / 4));
    }
}

}  // namespace controlspace
