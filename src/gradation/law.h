#pragma once

#include "geometry/point.h"
#include "metric/metric.h"

namespace controlspace {

/// How fast metrics may grow from place to place, for a gradation ratio g >= 1.
enum class GradationLaw {
    /// Seen from a node with metric M0, a metric at v may be at most M0 (1 + (g-1) |M0^-1 v|).
    /// Isotropic: h1 <= h0 + (g-1) |v|. The law of the exact reference.
    cone,
    /// The paper's (§3.2): the ratio of the two along the eigenvectors of either is at most
    /// 1 + (g-1) λ, λ the mean of v's two metric lengths.
    mean_length,
};

/// Gradation ratio g that gives an isotropic field the growth of MMG's `-hgrad`: 1 + ln(hgrad).
double gradation_ratio_from_mmg(double hgrad);

/// Gradation ratio g of refine's metric-space gradation β: 1 + ln(β).
double gradation_ratio_from_refine(double beta);

/// Growth ratios of two metrics along their eigenvectors (paper §3.2): `first_smaller` is how much
/// larger the second is than the first at most, `second_smaller` the reverse; 1 where it is not.
struct GrowthRatios {
    double first_smaller = 1;
    double second_smaller = 1;
};
GrowthRatios growth_ratios(const Metric& m0, const Metric& m1);

/// The gradation ratio that two metrics apart by `v` show under `law`: the least g >= 1 that would
/// leave both as they are. Paper §3.2: 1 + (max ratio - 1) / λ for the mean-length law.
double gradation_ratio(GradationLaw law, const Metric& m0, const Metric& m1, const Vector& v);

/// Applies `law` to two metrics apart by `v`: makes either smaller where the other asks for it.
struct Limited {
    bool first = false;   ///< m0 was made smaller
    bool second = false;  ///< m1 was made smaller
};
Limited limit_growth(GradationLaw law, double g, const Vector& v, Metric& m0, Metric& m1);

}  // namespace controlspace
