#pragma once

#include <sys/mman.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace controlspace {

/// Asks the system to lay memory that nobody has written yet out in large pages, where it has them:
/// first writes then take a quarter of the time, and answers at random places less.
inline void ask_for_large_pages(void* begin, std::size_t bytes) {
#ifdef MADV_HUGEPAGE
    constexpr std::size_t page = 4096, worthwhile = std::size_t{4} << 20;
    if (bytes < worthwhile) return;
    const std::size_t before = reinterpret_cast<std::uintptr_t>(begin) % page;
    const std::size_t skipped = before == 0 ? 0 : page - before;
    // No matter if it refuses.
    madvise(static_cast<char*>(begin) + skipped, bytes - skipped, MADV_HUGEPAGE);
#endif
}

/// Gives an array another capacity, of its size at least, in large pages.
template <class T>
void reallocate(std::vector<T>& array, std::size_t capacity) {
    std::vector<T> other;
    other.reserve(capacity);
    ask_for_large_pages(other.data(), capacity * sizeof(T));
    other.insert(other.end(), array.begin(), array.end());
    array = std::move(other);
}

/// An array of so many elements, in large pages; each made of `value`, if given.
template <class T, class... Value>
std::vector<T> large_array(std::size_t size, const Value&... value) {
    std::vector<T> array;
    reallocate(array, size);
    array.resize(size, value...);
    return array;
}

}  // namespace controlspace
