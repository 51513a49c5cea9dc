// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <array>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "controlspace/geometry/box.h"
#include "controlspace/metric/metric.h"
#include "controlspace/space/number_kind.h"

namespace controlspace {

/// What a structure holds, as named arrays of numbers, on its way into a file
/// (control_space_file.h). A reader takes the same calls, with variables to fill in place of
/// values.
class StateWriter {
public:
    /// Goes on behind what another one has written.
    explicit StateWriter(std::string bytes = {}) : bytes_(std::move(bytes)) {}

    /// Appends an array, compressed.
    template <class T>
    void operator()(std::string_view name, const std::vector<T>& values) {
        append(name, number_kind<T>(), sizeof(T), values.data(), values.size());
    }
    /// An array whose type is not known: of entries of so many bytes.
    void append(std::string_view name, NumberKind kind, std::size_t entry_size, const void* data,
                std::size_t entries);
    void operator()(std::string_view name, const std::string& text) {
        append(name, NumberKind::bytes, 1, text.data(), text.size());
    }
    void operator()(std::string_view name, double value) {
        append(name, NumberKind::reals, sizeof value, &value, 1);
    }
    void operator()(std::string_view name, const Box& box) {
        append(name, NumberKind::reals, sizeof box, &box, 1);
    }
    /// Counts, flags and, with the largest value that they have, enumerations.
    template <class T>
    requires std::integral<T>
    void operator()(std::string_view name, T value) {
        const auto count = static_cast<std::uint64_t>(value);
        append(name, NumberKind::counts, sizeof count, &count, 1);
    }
    template <class T>
    requires std::is_enum_v<T>
    void operator()(std::string_view name, T value, T) {
        (*this)(name, static_cast<std::uint64_t>(value));
    }

    const std::string& bytes() const { return bytes_; }

private:
    std::string bytes_;
};

/// Arrays that a StateWriter has written. Throws InputError, naming the file, for what is not there
/// or not as expected. Memory is allocated only as far as the bytes that are there can fill it.
class StateReader {
public:
    /// `bytes` must outlive it; `file` is for messages.
    StateReader(std::string_view bytes, std::string file);

    template <class T>
    void operator()(std::string_view name, std::vector<T>& values) const {
        const Array& array = find(name, number_kind<T>(), sizeof(T));
        values.clear();
        values.reserve(array.elements);
        decompress(name, array, [&](const void* piece, std::size_t elements) {
            const T* const first = static_cast<const T*>(piece);
            values.insert(values.end(), first, first + elements);
        });
    }
    /// An array whose type is not known: calls begin(entries), then append(piece, entries) with one
    /// piece after the other.
    void read(std::string_view name, NumberKind kind, std::size_t entry_size,
              const std::function<void(std::size_t)>& begin,
              const std::function<void(const void*, std::size_t)>& append) const {
        const Array& array = find(name, kind, entry_size);
        begin(array.elements);
        decompress(name, array, append);
    }
    void operator()(std::string_view name, std::string& text) const;
    void operator()(std::string_view name, double& value) const { value = only<double>(name); }
    void operator()(std::string_view name, Box& box) const { box = only<Box>(name); }
    template <class T>
    requires std::integral<T>
    void operator()(std::string_view name, T& value) const {
        const auto count = only<std::uint64_t>(name);
        value = static_cast<T>(count);
        require(static_cast<std::uint64_t>(value) == count, name, "is out of range");
    }
    template <class T>
    requires std::is_enum_v<T>
    void operator()(std::string_view name, T& value, T last) const {
        const auto count = only<std::uint64_t>(name);
        require(count <= static_cast<std::uint64_t>(last), name, "is out of range");
        value = static_cast<T>(count);
    }

    bool has(std::string_view name) const { return arrays_.contains(name); }

    /// Throws InputError unless `holds`: "FILE: its NAME WHAT".
    void require(bool holds, std::string_view name, std::string_view what) const {
        if (!holds) fail(name, what);
    }

private:
    struct Array {
        NumberKind kind;
        std::size_t element_size;
        std::size_t elements;
        std::vector<std::string_view> chunks;
    };

    [[noreturn]] void fail(std::string_view name, std::string_view what) const;
    const Array& find(std::string_view name, NumberKind kind, std::size_t element_size) const;
    /// Calls append(piece, elements) with one piece of the array after the other, on one thread at
    /// a time, while others decompress the next ones.
    void decompress(std::string_view name, const Array& array,
                    const std::function<void(const void*, std::size_t)>& append) const;
    template <class T>
    T only(std::string_view name) const {
        std::vector<T> values;
        (*this)(name, values);
        require(values.size() == 1, name, "is not a single value");
        return values.front();
    }

    std::string file_;
    std::map<std::string_view, Array> arrays_;
};

/// Whether `holds(value)` for all values; evaluated on all threads.
template <class T, class Predicate>
bool all_are(const std::vector<T>& values, const Predicate& holds) {
    constexpr std::size_t grain = 4096;
    return tbb::parallel_reduce(
        tbb::blocked_range<std::size_t>(0, values.size(), grain), true,
        [&](const tbb::blocked_range<std::size_t>& part, bool so_far) {
            const auto first = values.begin() + static_cast<std::ptrdiff_t>(part.begin());
            return so_far &&
                   std::all_of(first, first + static_cast<std::ptrdiff_t>(part.size()), holds);
        },
        std::logical_and<>());
}

/// Throws InputError unless all numbers are below `end`.
template <class T>
void require_below(const StateReader& state, std::string_view name, const std::vector<T>& values,
                   std::size_t end) {
    const auto is_below = [end](const T& value) {
        if constexpr (std::is_integral_v<T>) {
            return value < end;
        } else {
            return std::all_of(value.begin(), value.end(), [end](auto v) { return v < end; });
        }
    };
    state.require(all_are(values, is_below), name, "names what is not there");
}

/// Throws InputError unless all are positive definite.
void require_metrics(const StateReader& state, std::string_view name,
                     const std::vector<Metric>& metrics);

}  // namespace controlspace
