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

// Growth ratios along the eigenvectors of both metrics: how much larger each is than the other.
struct EigenRatios {
    double second_over_first = 1;
    double first_over_second = 1;
};

void compare_along(const EigenFrame& frame, const Metric& other, double& other_larger,
                   double& other_smaller) {
    for (int i = 0; i < 3; ++i) {
        const double d = frame.lengths[static_cast<std::size_t>(i)];
        const double h = (other.matrix() * frame.directions.col(i)).norm();
        other_larger = std::max(other_larger, h / d);
        other_smaller = std::max(other_smaller, d / h);
    }
}

EigenRatios eigen_ratios(const Metric& m0, const Metric& m1) {
    EigenRatios ratios;
    compare_along(eigen_frame(m0), m1, ratios.second_over_first, ratios.first_over_second);
    compare_along(eigen_frame(m1), m0, ratios.first_over_second, ratios.second_over_first);
    return ratios;
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
    return {eigen_ratios(from, to).second_over_first, length};
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
