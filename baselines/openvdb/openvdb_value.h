#pragma once

#include <openvdb/tree/Tree.h>

#include <cmath>
#include <ostream>
#include <tuple>

#include "controlspace/metric/metric.h"

namespace controlspace {

/// A metric as the value of an OpenVDB tree, with the arithmetic, entry by entry, that the library
/// requests of a value. Its order is lexicographic and means nothing for metrics: tools that
/// compare values (prune with a tolerance, minimum and maximum) are of no use on such a tree.
struct VdbMetric {
    Metric metric;

    VdbMetric() = default;
    explicit VdbMetric(const Metric& m) : metric(m) {}
    /// All six entries alike; the library's zero is VdbMetric(0).
    explicit VdbMetric(double entry) : metric{entry, entry, entry, entry, entry, entry} {}

    bool operator==(const VdbMetric&) const = default;
};

inline VdbMetric operator+(const VdbMetric& a, const VdbMetric& b) {
    return VdbMetric(Metric{a.metric.xx + b.metric.xx, a.metric.yy + b.metric.yy,
                            a.metric.zz + b.metric.zz, a.metric.xy + b.metric.xy,
                            a.metric.xz + b.metric.xz, a.metric.yz + b.metric.yz});
}
inline VdbMetric operator*(const VdbMetric& a, double factor) {
    return VdbMetric(factor * a.metric);
}
inline VdbMetric operator-(const VdbMetric& a) { return a * -1.0; }
inline VdbMetric operator-(const VdbMetric& a, const VdbMetric& b) { return a + -b; }
inline bool operator<(const VdbMetric& a, const VdbMetric& b) {
    const auto entries = [](const Metric& m) {
        return std::tie(m.xx, m.yy, m.zz, m.xy, m.xz, m.yz);
    };
    return entries(a.metric) < entries(b.metric);
}
inline bool operator>(const VdbMetric& a, const VdbMetric& b) { return b < a; }
/// Found by argument-dependent lookup.
inline VdbMetric Abs(const VdbMetric& a) {  // NOLINT(readability-identifier-naming): OpenVDB's name
    const Metric& m = a.metric;
    return VdbMetric(Metric{std::abs(m.xx), std::abs(m.yy), std::abs(m.zz), std::abs(m.xy),
                            std::abs(m.xz), std::abs(m.yz)});
}
inline std::ostream& operator<<(std::ostream& out, const VdbMetric& a) {
    return out << to_string(a.metric);
}

/// The library's standard tree: leaves of 8^3 voxels below inner nodes of 16^3 and 32^3.
using VdbMetricTree = openvdb::tree::Tree4<VdbMetric, 5, 4, 3>::Type;

}  // namespace controlspace
