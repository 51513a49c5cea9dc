// SPDX-License-Identifier: Apache-2.0
#include "controlspace/gradation/law.h"

#include <fmt/format.h>

#include "controlspace/error.h"
#include "controlspace/metric/intersection.h"

namespace controlspace {

namespace {

double one_plus_log(const char* name, double value) {
    if (!std::isfinite(value) || value < 1) {
        throw InputError(fmt::format("{} is {}: give a finite value of at least 1", name, value));
    }
    return 1 + std::log(value);
}

// How many times larger `to` is than `from`, at most, along the eigenvectors of either; 1 at least.
double largest_eigen_ratio(const Metric& from, const Metric& to) {
    double ratio = 1;
    const EigenFrame of_from = eigen_frame(from);
    const EigenFrame of_to = eigen_frame(to);
    for (int i = 0; i < 3; ++i) {
        const double along_from = (to.matrix() * of_from.directions.col(i)).norm();
        const double along_to = (from.matrix() * of_to.directions.col(i)).norm();
        ratio = std::max({ratio, along_from / of_from.lengths[static_cast<std::size_t>(i)],
                          of_to.lengths[static_cast<std::size_t>(i)] / along_to});
    }
    return ratio;
}

// The cone of `by` at the far end of `v`, cutting `m`.
bool limit_by_cone(double g, const Metric& by, const Vector& v, Metric& m) {
    const double factor = 1 + (g - 1) * metric_length(by, v);
    if (is_within(m, factor * (1 + Growth::settled), by)) return false;
    m = intersection(m, factor * by);
    return true;
}

bool limit_by_ratio(double g, const Metric& by, const Growth& growth, Metric& m) {
    if (!growth.exceeds(g)) return false;
    m = intersection(m, growth.allowed(g) * by);
    return true;
}

}  // namespace

double gradation_ratio_from_mmg(double hgrad) { return one_plus_log("hgrad", hgrad); }
double gradation_ratio_from_refine(double beta) { return one_plus_log("beta", beta); }

Growth growth_between(GradationLaw law, const Metric& from, const Metric& to, const Vector& v) {
    if (law == GradationLaw::cone) {
        return {std::max(1.0, growth(to, from)), metric_length(from, v)};
    }
    const double length = 0.5 * (metric_length(from, v) + metric_length(to, v));
    if (is_isotropic(from) && is_isotropic(to)) return {std::max(1.0, to.xx / from.xx), length};
    return {largest_eigen_ratio(from, to), length};
}

Limited limit_anisotropic_growth(GradationLaw law, double g, const Vector& v, Metric& m0,
                                 Metric& m1) {
    const Metric old0 = m0;
    Limited limited;
    if (law == GradationLaw::cone) {
        limited.first = limit_by_cone(g, m1, v, m0);
        limited.second = limit_by_cone(g, old0, v, m1);
        return limited;
    }
    const Growth to_second = growth_between(law, m0, m1, v);
    const Growth to_first = growth_between(law, m1, m0, v);
    limited.first = limit_by_ratio(g, m1, to_first, m0);
    limited.second = limit_by_ratio(g, old0, to_second, m1);
    return limited;
}

}  // namespace controlspace
