// SPDX-License-Identifier: Apache-2.0
#include "controlspace/space/split_rule.h"

namespace controlspace {

namespace {

Axis longest_axis(const std::array<double, 3>& lengths) {
    if (lengths[0] > lengths[1] && lengths[0] > lengths[2]) return 0;
    return lengths[1] > lengths[2] ? 1 : 2;
}

// Fraction of the edge at which s_M cuts: `length` is the edge's, `t` the source's fraction of it.
double metric_fraction(double length, double t, double l_min) {
    const double k = l_min / length;
    if (length < 2 * l_min) return 0.5;
    if (t <= k) return k;
    if (1 - t <= k) return 1 - k;
    return t < 0.5 ? t + 0.5 * k : t - 0.5 * k;
}

// With exact golden sections, an edge cut once near its end and one cut twice near its middle are
// equally long but for rounding. To five digits 0.61803² < 0.38197: the former is the longer one,
// which gives trees of the published sizes.
double golden_fraction(double t) { return t < 0.5 ? 0.38197 : 0.61803; }
double exact_golden_fraction(double t) {
    constexpr double upper = 0.61803398874989485;
    return t < 0.5 ? 1 - upper : upper;
}

}  // namespace

Subdivision cut(SplitRule rule, const Box& box, const PointSource& source, double l_min) {
    const std::array<double, 3> lengths = metric_edge_lengths(source.metric, box.edges());
    const Axis axis = longest_axis(lengths);
    const double low = box.low[axis];
    const double high = box.high[axis];
    const double t = (source.position[axis] - low) / (high - low);
    switch (rule) {
        case SplitRule::middle:
            break;
        case SplitRule::golden:
            return halves(box, axis, low + golden_fraction(t) * (high - low));
        case SplitRule::exact_golden:
            return halves(box, axis, low + exact_golden_fraction(t) * (high - low));
        case SplitRule::metric: {
            const double length = lengths[static_cast<std::size_t>(axis)];
            return halves(box, axis, low + metric_fraction(length, t, l_min) * (high - low));
        }
    }
    return halves(box, axis, 0.5 * (low + high));
}

}  // namespace controlspace
