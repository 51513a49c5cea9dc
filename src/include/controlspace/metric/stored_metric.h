#pragma once

#include <type_traits>

#include "controlspace/metric/metric.h"

namespace controlspace {

/// Type of the numbers in the metrics of a compact form.
enum class Precision { doubles, floats };

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
