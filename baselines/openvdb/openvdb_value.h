// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <openvdb/tree/Tree.h>

#include <cmath>
#include <ostream>
#include <tuple>

#include "controlspace/metric/metric.h"

namespace controlspace {

/// A metric as the value of an OpenVDB tree, in doubles (`M` is Metric) or floats (StoredMetric),
/// with the arithmetic, entry by entry, that the library requests of a value. Its order is
/// lexicographic and means nothing for metrics: tools that compare values (prune with a tolerance,
/// minimum and maximum) are of no use on such a tree.
template <class M>
struct VdbTensor {
    M metric;

    VdbTensor() = default;
    explicit VdbTensor(const M& m) : metric(m) {}
    /// All six entries alike; the library's zero is VdbTensor(0).
    explicit VdbTensor(double entry) : metric(Metric{entry, entry, entry, entry, entry, entry}) {}

    auto entries() const {
        return std::tie(metric.xx, metric.yy, metric.zz, metric.xy, metric.xz, metric.yz);
    }
    bool operator==(const VdbTensor& other) const { return entries() == other.entries(); }
    bool operator<(const VdbTensor& other) const { return entries() < other.entries(); }
    bool operator>(const VdbTensor& other) const { return other < *this; }
};
using VdbMetric = VdbTensor<Metric>;

template <class M>
VdbTensor<M> operator+(const VdbTensor<M>& a, const VdbTensor<M>& b) {
    const M &m = a.metric, &n = b.metric;
    return VdbTensor<M>(
        M(Metric{m.xx + n.xx, m.yy + n.yy, m.zz + n.zz, m.xy + n.xy, m.xz + n.xz, m.yz + n.yz}));
}
template <class M>
VdbTensor<M> operator*(const VdbTensor<M>& a, double factor) {
    return VdbTensor<M>(M(factor * Metric(a.metric)));
}
template <class M>
VdbTensor<M> operator-(const VdbTensor<M>& a) {
    return a * -1.0;
}
template <class M>
VdbTensor<M> operator-(const VdbTensor<M>& a, const VdbTensor<M>& b) {
    return a + -b;
}
/// Found by argument-dependent lookup.
template <class M>
VdbTensor<M> Abs(const VdbTensor<M>& a) {  // NOLINT(readability-identifier-naming): OpenVDB's name
    const M& m = a.metric;
    return VdbTensor<M>(M(Metric{std::abs(m.xx), std::abs(m.yy), std::abs(m.zz), std::abs(m.xy),
                                 std::abs(m.xz), std::abs(m.yz)}));
}
template <class M>
std::ostream& operator<<(std::ostream& out, const VdbTensor<M>& a) {
    return out << to_string(Metric(a.metric));
}

/// The library's standard tree: leaves of 8^3 voxels below inner nodes of 16^3 and 32^3.
template <class Value>
using VdbTree543 = typename openvdb::tree::Tree4<Value, 5, 4, 3>::Type;
using VdbMetricTree = VdbTree543<VdbMetric>;

}  // namespace controlspace
