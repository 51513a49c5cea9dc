#pragma once

#include <cstddef>
#include <utility>
#include <vector>

namespace controlspace {

/// Requests huge pages for memory that has not been touched yet, where the system has them: first
/// writes then take a quarter of the time, and reads at random places less.
void request_large_pages(void* begin, std::size_t bytes);

/// Gives an array another capacity, of its size at least, in huge pages.
template <class T>
void reallocate(std::vector<T>& array, std::size_t capacity) {
    std::vector<T> other;
    other.reserve(capacity);
    request_large_pages(other.data(), capacity * sizeof(T));
    other.insert(other.end(), array.begin(), array.end());
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
