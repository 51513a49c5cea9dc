// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>

#include "controlspace/geometry/point.h"
#include "controlspace/metric/metric.h"

namespace controlspace {

/// How fast metrics may grow with distance, for a gradation ratio g_r >= 1, here g.
enum class GradationLaw {
    /// Seen from a node with metric M0, a metric at v may be at most M0 (1 + (g-1) |M0^-1 v|).
    /// Isotropic: h1 <= h0 + (g-1) |v|. The law of the exact reference.
    cone,
    /// The paper's (§3.2): the ratio of the two metrics along the eigenvectors of either is at most
    /// 1 + (g-1) λ, where λ is the mean of v's two metric lengths.
    mean_length,
};

/// Gradation ratio g that gives an isotropic field the growth of MMG's `-hgrad`: 1 + ln(hgrad).
/// Throws InputError for a value below 1 or not finite; so does the next.
double gradation_ratio_from_mmg(double hgrad);

/// Gradation ratio g of refine's metric-space gradation β: 1 + ln(β).
double gradation_ratio_from_refine(double beta);

/// How a metric grows towards a neighbour, as one law measures it.
struct Growth {
    double ratio = 1;   ///< by which factor the neighbour is larger, at most; 1 if it is not
    double length = 0;  ///< the law's distance between the two, in metric lengths (λ)

    /// The largest ratio that gradation ratio g allows at this distance.
    double allowed(double g) const { return 1 + (g - 1) * length; }
    /// The gradation ratio of this growth (paper §3.2), 1 or more; at most g if `exceeds(g)` is
    /// false, however close the two nodes are.
    double gradation() const {
        const double growth = ratio / (1 + settled) - 1;
        return growth > 0 ? 1 + growth / length : 1;
    }
    bool exceeds(double g) const { return ratio > allowed(g) * (1 + settled); }

    /// Relative growth that counts as none: rounding of strongly anisotropic metrics stays below.
    static constexpr double settled = 1e-9;
};

/// Growth from metric `from` to metric `to`, the displacement between them being `v`.
///   cone:        ratio = least k with `to` within k `from`; length = |from^-1 v|
///   mean_length: ratio over the eigenvectors of both; length = (|from^-1 v| + |to^-1 v|) / 2
Growth growth_between(GradationLaw law, const Metric& from, const Metric& to, const Vector& v);

/// Its gradation ratio.
inline double gradation_between(GradationLaw law, const Metric& from, const Metric& to,
                                const Vector& v) {
    const bool shrinks = is_isotropic(from) && is_isotropic(to) && to.xx <= from.xx;
    return shrinks ? 1 : growth_between(law, from, to, v).gradation();
}

/// Which of two metrics was made smaller.
struct Limited {
    bool first = false;
    bool second = false;
};

/// The general case of limit_growth.
Limited limit_anisotropic_growth(GradationLaw law, double g, const Vector& v, Metric& m0,
                                 Metric& m1);

/// The cone law for isotropic metrics: the largest size at displacement `v` from size h.
inline double cone_limit(double h, double g, const Vector& v) { return h + (g - 1) * v.norm(); }

/// Applies `law` to two metrics at displacement `v`: makes either smaller if it exceeds what the
/// other allows.
///
/// For isotropic metrics under the cone law the limit is h0 + (g-1)|v| in floating point, which is
/// monotone in h0: so the fixed point of a whole graph is unique, to the bit, whatever the order of
/// its pairs.
inline Limited limit_growth(GradationLaw law, double g, const Vector& v, Metric& m0, Metric& m1) {
    if (!is_isotropic(m0) || !is_isotropic(m1)) {
        return limit_anisotropic_growth(law, g, v, m0, m1);
    }
    const bool second = m0.xx < m1.xx;
    const double small = second ? m0.xx : m1.xx;
    Metric& large = second ? m1 : m0;
    double limit = cone_limit(small, g, v);
    if (law == GradationLaw::mean_length)
        limit = small + 0.5 * (limit - small) * (1 + small / large.xx);
    if (large.xx <= limit) return {};
    large = Metric::isotropic(limit);
    return {!second, second};
}

}  // namespace controlspace
