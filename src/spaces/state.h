#pragma once

#include <algorithm>
#include <array>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "geometry/box.h"
#include "metric/metric.h"

namespace controlspace {

/// What numbers an array of a state consists of, as the file has it.
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

/// What a structure holds, as named arrays of numbers, on its way into a file
/// (control_space_file.h). A reader takes the same calls, with variables to fill in place of
/// values.
class StateWriter {
public:
    /// Appends an array, compressed.
    template <class T>
    void operator()(std::string_view name, const std::vector<T>& values) {
        append(name, number_kind<T>(), sizeof(T), values.data(), values.size());
    }
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
    void append(std::string_view name, NumberKind kind, std::size_t element_size, const void* data,
                std::size_t elements);

    std::string bytes_;
};

/// Arrays that a StateWriter has written. Throws InputError, naming the file, for what is not there
/// or not as expected. Memory is asked for only as far as the bytes that are there can fill it.
class StateReader {
public:
    /// `bytes` must outlive it; `file` is for messages.
    StateReader(std::string_view bytes, std::string file);

    template <class T>
    void operator()(std::string_view name, std::vector<T>& values) const {
        const Array& array = find(name, number_kind<T>(), sizeof(T));
        values.clear();
        values.reserve(array.elements);
        // By way of a piece that stays in the cache: so that the array is written once.
        std::vector<T> piece(std::min(array.elements, elements_per_chunk(sizeof(T))));
        for (const std::string_view chunk : array.chunks) {
            const std::size_t n = std::min(piece.size(), array.elements - values.size());
            decompress(name, chunk, piece.data(), n * sizeof(T));
            values.insert(values.end(), piece.begin(),
                          piece.begin() + static_cast<std::ptrdiff_t>(n));
        }
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

    static std::size_t elements_per_chunk(std::size_t element_size);
    [[noreturn]] void fail(std::string_view name, std::string_view what) const;
    const Array& find(std::string_view name, NumberKind kind, std::size_t element_size) const;
    void decompress(std::string_view name, std::string_view chunk, void* out,
                    std::size_t size) const;
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
    state.require(std::all_of(values.begin(), values.end(), is_below), name,
                  "names what is not there");
}

/// Throws InputError unless all are positive definite.
void require_metrics(const StateReader& state, std::string_view name,
                     const std::vector<Metric>& metrics);

}  // namespace controlspace
