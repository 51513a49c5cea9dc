// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

namespace controlspace {

/// Requests huge pages for memory that has not been touched yet, where the system has them: first
/// writes then take a quarter of the time, and reads at random places less.
void request_large_pages(void* begin, std::size_t bytes);

/// Gives memory back to the system that is read no more, but for the pages at its ends; what it
/// holds is lost.
void give_back(void* begin, std::size_t bytes);

/// Of an array that is given another capacity, so many bytes are there twice, at most.
constexpr std::size_t most_bytes_twice = std::size_t{64} << 20;

/// Gives an array another capacity, of its size at least, in huge pages; it moves piece by piece.
template <class T>
void reallocate(std::vector<T>& array, std::size_t capacity) {
    static_assert(std::is_trivially_destructible_v<T>);
    constexpr std::size_t piece = most_bytes_twice / sizeof(T);
    std::vector<T> other;
    other.reserve(capacity);
    request_large_pages(other.data(), capacity * sizeof(T));
    for (std::span<T> left(array); !left.empty();) {
        const std::span<T> next = left.first(std::min(piece, left.size()));
        other.insert(other.end(), next.begin(), next.end());
        left = left.subspan(next.size());
        if (!left.empty()) give_back(next.data(), next.size_bytes());
    }
    array = std::move(other);
}

/// An array of so many elements, in huge pages; each made of `value`, if given.
template <class T, class... Value>
std::vector<T> large_array(std::size_t size, const Value&... value) {
    std::vector<T> array;
    reallocate(array, size);
    array.resize(size, value...);
    return array;
}

}  // namespace controlspace
