// SPDX-License-Identifier: Apache-2.0
#include "space/adapt_for_precision.h"

#include <algorithm>
#include <cmath>

#include "controlspace/metric/nonconformity.h"
#include "controlspace/metric/stored_metrics.h"
#include "controlspace/sources/point_source.h"
#include "refuse.h"

namespace controlspace {

AdaptationReport adapt_for_precision(
    const AdaptationGoal& goal, double longest, int order,
    const std::function<AdaptationReport(const AdaptationGoal&)>& adapt,
    const std::function<std::vector<Metric>()>& held) {
    if (goal.precision == Precision::doubles) return adapt(goal);
    const bool is_code = goal.precision != Precision::floats;
    const bool are_lengths =
        is_code || (!goal.continuous && std::ranges::all_of(goal.sources, [](const PointSource& s) {
            return is_isotropic(s.metric);
        }));
    const double allowed = largest_factor_within(goal.target);
    const double most_rounding = is_code ? std::cbrt(allowed) : allowed;
    double shortest = longest;
    for (const PointSource& s : goal.sources) shortest = std::min(shortest, s.metric.xx);
    const auto require_fine = [&](double rounding) {
        if (!is_code || rounding <= most_rounding) return;
        refuse(
            "codes of {} bits round lengths by {:.2g} %, more than a third of what the target "
            "{:.4g} "
            "allows (lengths within {:.4g}x): use {}, or a larger target",
            goal.precision == Precision::log8 ? 8 : 16, 100 * (rounding - 1), goal.target, allowed,
            goal.precision == Precision::log8 ? "codes of 16 bits or floats" : "floats");
    };
    const bool depends_on_range = goal.precision == Precision::log8;
    const auto rounding_for = [&](double least, double most) {
        const double rounding = rounding_of(goal.precision, are_lengths, least, most);
        return order < 2 ? rounding : rounding * rounding;
    };
    double expected = rounding_for(shortest, longest);
    if (!depends_on_range) require_fine(expected);
    expected = std::min(expected, most_rounding);

    AdaptationReport report;
    constexpr int most_rounds = 3;
    for (int round = 1;; ++round) {
        AdaptationGoal reduced = goal;
        reduced.target = nonconformity_of_factor(std::max(1.0, allowed / expected));
        report = adapt(reduced);
        double rounding = expected;
        if (depends_on_range) {
            const std::vector<Metric> metrics = held();
            const auto [least, most] = std::ranges::minmax(metrics, {}, &Metric::xx);
            rounding = rounding_for(least.xx, most.xx);
            require_fine(rounding);
        }
        const bool is_done = rounding <= expected;
        if (is_done || round == most_rounds || report.stop != GrowthStop::none) {
            if (report.met && !is_done) {
                report.met = report.is_bound = false;
                report.shortfall =
                    "codes round by more in each tree that makes room for them: use "
                    "codes of 16 bits or floats";
            }
            if (std::isinf(report.reached)) return report;
            // Where the target is met it is to be kept, whichever way the quotient is rounded.
            const double reached =
                nonconformity_of_factor(largest_factor_within(report.reached) * rounding);
            report.reached = report.met ? std::min(reached, goal.target) : reached;
            return report;
        }
        expected = rounding * (1 + 1e-3 * (rounding - 1));
    }
}

}  // namespace controlspace
