// SPDX-License-Identifier: Apache-2.0
#include "cones/undominated.h"

#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

#include "controlspace/metric/intersection.h"
#include "controlspace/sources/cone.h"
#include "metric/decompose.h"

namespace controlspace {

// Source i may be left out if a source j has C_j < C_i, for the cones C = M (1 + s |M^-1 (p - Q)|),
// s = g - 1, wherever C_i is shorter than the cap in any direction: what is within C_j and the cap
// is within C_i too. Where cones are intersected in turn, the smallest length of C_j is less there,
// so C_j comes first. Lengths get strictly smaller from i to j to j's own dominator and on, so all
// such sources may be left out at once. Let v = p - Q_i, t = s_i |M_i^-1 v|, k = f_j(Q_i), and r
// = s_j / s_i max |M_j^-1 u| / |M_i^-1 u| over all u, the growth from M_j to M_i. Then
//     C_i = (1 + t) M_i,    C_j <= (k + s_j |M_j^-1 v|) M_j <= (k + r t) M_j,
// by the triangle inequality. C_i matters for t < T = cap / (smallest length of M_i) - 1 only, and
// (k + r t) / (1 + t) is monotonous in t, so it is at most s = max(k, (k + r T) / (1 + T)):
//     s M_j < M_i    is enough.
// Of equal sources at one place all but the first change nothing, and are left out too.

namespace {

bool is_dominated(const PointSource& source, double length, const UndominatedSources& all, double g,
                  double cap) {
    const double certain = 1 - all.uncertainty;
    const double reach = std::max(0.0, cap / length - 1);
    const Point& q = source.position;
    const Metric squared = square(source.metric);
    const auto by = [&](const PointSource& other) {
        const double k = cone_factor(other, g, q);
        const auto is_within = [&](double factor) {
            const double safe = factor / certain;
            return is_below(safe * safe * square(other.metric), 1, squared);
        };
        if (!is_within(k)) return false;
        const double steeper = (cone_growth(other, g) - 1) / (cone_growth(source, g) - 1);
        // Without growth of both, of the field, s_j / s_i is any number.
        const double r = (std::isnan(steeper) ? 1 : steeper) * growth(source.metric, other.metric);
        if (std::isinf(r)) return false;
        return is_within(std::max(k, (k + r * reach) / (1 + reach)));
    };
    const auto does_not_dominate = [&](std::uint32_t number) {
        const TensorLeaf& leaf = all.tree.leaf(number);
        const Lanes lengths = cone_factors(leaf, q) * leaf.length;
        for (int lane = 0; lane < lane_count; ++lane) {
            if (!(lengths[lane] < certain * length)) continue;
            if (by(leaf[lane])) return false;
        }
        return true;
    };
    return !all.tree.search([&] { return certain * length; },
                            [&](const TensorNode& node) -> Lanes {
                                return least_cone_factors(node, all.uncertainty, q) * node.length;
                            },
                            does_not_dominate);
}

}  // namespace

UndominatedSources undominated_sources(std::span<const PointSource> sources, double g, double cap) {
    UndominatedSources all;
    std::vector<double>& lengths = all.lengths;
    lengths.resize(sources.size());
    std::vector<double> anisotropies(sources.size());
    tbb::parallel_for(std::size_t{0}, sources.size(), [&](std::size_t i) {
        const auto of_source = eigen_frame(sources[i].metric).lengths;
        lengths[i] = of_source[0];
        anisotropies[i] = of_source[2] / of_source[0];
    });
    double anisotropy = 1;
    for (const double a : anisotropies) anisotropy = std::max(anisotropy, a);
    all.uncertainty = std::min(4096 * std::numeric_limits<double>::epsilon() * anisotropy, 1.0);

    const double weight = g > 1 ? 1 / (g - 1) : 1;
    std::vector<ConeTreeItem>& items = all.items;
    items.resize(sources.size());
    for (std::size_t i = 0; i < sources.size(); ++i) {
        const Point& q = sources[i].position;
        items[i] = {{q.x(), q.y(), q.z(), weight * lengths[i]}, static_cast<std::uint32_t>(i)};
    }
    const auto source_of = [&](const ConeTreeItem& item) -> const PointSource& {
        return sources[item.index];
    };
    const auto key = [&](const ConeTreeItem& item) {
        const auto& [q, m, growth] = source_of(item);
        return std::tie(q.x(), q.y(), q.z(), m.xx, m.yy, m.zz, m.xy, m.xz, m.yz, growth,
                        item.index);
    };
    tbb::parallel_sort(
        items.begin(), items.end(),
        [&](const ConeTreeItem& a, const ConeTreeItem& b) { return key(a) < key(b); });
    const auto end = std::unique(
        items.begin(), items.end(),
        [&](const ConeTreeItem& a, const ConeTreeItem& b) { return source_of(a) == source_of(b); });
    items.erase(end, items.end());
    const std::size_t kept = build_without_dominated(
        items,
        [&](std::span<ConeTreeItem> some) {
            all.tree = build_tensor_tree(some, sources, lengths, g);
        },
        [&](const ConeTreeItem& item) {
            return is_dominated(source_of(item), lengths[item.index], all, g, cap);
        });
    all.dropped = sources.size() - kept;
    return all;
}

Lanes least_cone_factors(const TensorNode& node, double uncertainty, const Point& p) {
    const Lanes away = lengths_of_products(node.inverse, displacements(node.centre, p));
    return 1 + (node.growth - 1) *
                   ((1 - uncertainty) * away - (1 + uncertainty) * node.radius).max(0.0);
}

Lanes cone_factors(const TensorLeaf& leaf, const Point& p) {
    return 1 + (leaf.growth - 1) * metric_lengths(leaf.metric, displacements(leaf.position, p));
}

}  // namespace controlspace
