#include "spaces/split_rule.h"

#include <algorithm>

namespace controlspace {

namespace {

Axis longest_axis(const std::array<double, 3>& lengths) {
    constexpr double tie = 1 - 1e-9;
    const double longest = std::max({lengths[0], lengths[1], lengths[2]});
    if (lengths[2] >= tie * longest) return 2;
    return lengths[1] >= tie * longest ? 1 : 0;
}

// Fraction of the edge at which s_M cuts: `length` is the edge's, `t` the source's fraction of it.
double metric_fraction(double length, double t, double l_min) {
    const double k = l_min / length;
    if (length < 2 * l_min) return 0.5;
    if (t <= k) return k;
    if (1 - t <= k) return 1 - k;
    return t < 0.5 ? t + 0.5 * k : t - 0.5 * k;
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
        case SplitRule::golden: {
            // To six digits, as published: 0.618034² then differs from 0.381966 by 7e-8, which
            // decides between edges that exact golden sections would make equally long.
            constexpr double minor = 0.381966;
            return halves(box, axis, low + (t <= 0.5 ? minor : 1 - minor) * (high - low));
        }
        case SplitRule::metric: {
            const double length = lengths[static_cast<std::size_t>(axis)];
            return halves(box, axis, low + metric_fraction(length, t, l_min) * (high - low));
        }
    }
    return halves(box, axis, 0.5 * (low + high));
}

}  // namespace controlspace
