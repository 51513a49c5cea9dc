// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "controlspace/metric/metric.h"

namespace controlspace {

/// The numbers that a finished structure stores its metrics in: six doubles or floats each, or,
/// where all are isotropic, their lengths in one. log16 and log8 hold lengths alone, as codes of 16
/// and 8 bits, whose steps are equal ratios.
enum class Precision { doubles, floats, log16, log8 };

/// A metric in six numbers of another type; floats round each by a relative 6e-8 at most.
template <class Number>
struct StoredMetric {
    Number xx = 1, yy = 1, zz = 1, xy = 0, xz = 0, yz = 0;

    StoredMetric() = default;
    explicit StoredMetric(const Metric& m)
        : xx(static_cast<Number>(m.xx)),
          yy(static_cast<Number>(m.yy)),
          zz(static_cast<Number>(m.zz)),
          xy(static_cast<Number>(m.xy)),
          xz(static_cast<Number>(m.xz)),
          yz(static_cast<Number>(m.yz)) {}
    operator Metric() const { return {xx, yy, zz, xy, xz, yz}; }
};

/// An isotropic metric in one number, its length; floats round it likewise.
template <class Number>
struct StoredLength {
    Number h = 1;

    StoredLength() = default;
    explicit StoredLength(const Metric& isotropic) : h(static_cast<Number>(isotropic.xx)) {}
    operator Metric() const { return Metric::isotropic(h); }
};

/// A length that is kept as a code (Packing), as it is read from there.
template <>
struct StoredLength<std::uint16_t> : StoredLength<double> {
    using StoredLength<double>::StoredLength;
};
template <>
struct StoredLength<std::uint8_t> : StoredLength<double> {
    using StoredLength<double>::StoredLength;
};

/// How arrays keep metrics of type M: as they are.
template <class M>
struct Packing {
    using Item = M;

    const M& operator()(const M& item) const { return item; }
};

/// Lengths in 16 bits: the shortest one times a power of `step`, rounded by a relative
/// sqrt(step) - 1 < 1e-4; the longest is up to 4.9e5 times the shortest. They are products of two
/// tables, which are made by multiplication alone: the same bits on every machine.
template <>
struct Packing<StoredLength<std::uint16_t>> {
    using Item = std::uint16_t;

    static constexpr double step = 1.0002;
    static constexpr std::size_t fine_steps = 256;
    /// Powers of the step.
    static constexpr std::array<double, fine_steps + 1> fine = [] {
        std::array<double, fine_steps + 1> powers{};
        double next = 1;
        for (double& power : powers) {
            power = next;
            next *= step;
        }
        return powers;
    }();

    const double* table = nullptr;  ///< lengths `fine_steps` steps apart, from the shortest on

    StoredLength<std::uint16_t> operator()(Item code) const {
        return StoredLength<std::uint16_t>(
            Metric::isotropic(table[code / fine_steps] * fine[code % fine_steps]));
    }
};

/// Lengths in 8 bits: one of 256 in equal ratios, from the shortest to the longest that there is,
/// both of which are exact. Rounded by half a step, (longest / shortest)^(1/510) - 1 at most.
template <>
struct Packing<StoredLength<std::uint8_t>> {
    using Item = std::uint8_t;

    static constexpr std::size_t codes = 256;

    const double* table = nullptr;  ///< the lengths

    StoredLength<std::uint8_t> operator()(Item code) const {
        return StoredLength<std::uint8_t>(Metric::isotropic(table[code]));
    }
};

template <class M>
inline constexpr bool is_stored_length = false;
template <class Number>
inline constexpr bool is_stored_length<StoredLength<Number>> = true;

/// The length of what is known to be isotropic.
template <class M>
double length_of(const M& m) {
    if constexpr (is_stored_length<M>) {
        return m.h;
    } else {
        return m.xx;
    }
}

/// An isotropic value as a Metric, or as its length where `Value` is double.
template <class Value>
Value isotropic_value(double h) {
    if constexpr (std::is_same_v<Value, double>) {
        return h;
    } else {
        return Metric::isotropic(h);
    }
}

}  // namespace controlspace
