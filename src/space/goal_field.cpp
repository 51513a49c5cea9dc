// SPDX-License-Identifier: Apache-2.0
#include "space/goal_field.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "cones/cone_field.h"
#include "controlspace/error.h"
#include "controlspace/metric/nonconformity.h"
#include "controlspace/metric/stored_metrics.h"
#include "controlspace/sources/cone.h"
#include "controlspace/space/control_space_builder.h"
#include "controlspace/space/sample_parallel.h"
#include "controlspace/space/space_options.h"
#include "geometry/place_sequence.h"
#include "require_known.h"
#include "space/goal_cache.h"
#include "space/until_late.h"

namespace controlspace {

namespace {

const AdaptationGoal& require_valid(const AdaptationGoal& goal, const Box& domain) {
    require_valid(GradationOptions{.ratio = goal.ratio});
    require_known("intersection", goal.intersection, IntersectionRule::in_turn);
    controlspace::require_valid(goal.precision);
    require_known("values", goal.values, NodeValues::fitted);
    // Structures that fit values take a goal's field without them.
    if (goal.values == NodeValues::fitted) {
        throw InputError(
            "this structure takes the field's own values at its nodes and fits none: give values "
            "`field`, or take one that is trilinear");
    }
    if (!(goal.target > 0) || !std::isfinite(goal.target)) {
        throw InputError(
            fmt::format("target_delta is {}: give a positive non-conformity", goal.target));
    }
    if (!(goal.h_max > 0)) {
        throw InputError(fmt::format("h_max is {}: give a positive length", goal.h_max));
    }
    for (std::size_t i = 0; i < goal.sources.size(); ++i) {
        controlspace::require_valid(goal.sources[i], i, domain);
    }
    return goal;
}

// Some hundredth of the target, as δ.
double negligible_for(double target) { return 0.1 * std::sqrt(target); }

double tolerance_for(const AdaptationGoal& goal) {
    const bool is_order_free = goal.intersection == IntersectionRule::order_free;
    if (!is_order_free) return negligible_for(goal.target);
    const double share = goal.sources.size() <= GoalField::few_sources ? 0.01 : 0.1;
    return std::min(share * goal.target, 0.1);
}

// By which thinned lengths may be longer. A continuous field may be of tensors, for which factors
// of lengths are not all that counts.
double longest_thinned(const AdaptationGoal& goal, GoalField::Thinning thinning) {
    constexpr double share = 0.1;
    if (thinning == GoalField::Thinning::none || goal.continuous) return 1;
    return std::pow(largest_factor_within(goal.target), share);
}

}  // namespace

GoalField::GoalField(const AdaptationGoal& goal, const Box& domain, std::size_t most_answers,
                     Thinning thinning)
    : whole_target_(require_valid(goal, domain).target),
      target_(whole_target_),
      ratio_(goal.ratio),
      largest_ratio_(std::max(goal.ratio, largest_growth(goal.sources, goal.ratio))),
      sources_(goal.sources),
      continuous_(goal.continuous),
      largest_(largest_metric(domain, goal.h_max)),
      cones_(std::make_unique<ConeField>(goal.sources, goal.ratio, largest_, tolerance_for(goal),
                                         goal.intersection, longest_thinned(goal, thinning))),
      cache_(std::make_unique<GoalCache>(most_answers)) {
    if (cones_->longer() == 1) return;
    target_ = nonconformity_of_factor(largest_factor_within(target_) / cones_->longer());
}

GoalField::~GoalField() = default;

bool GoalField::has_ranges() const { return continuous_ == nullptr && cones_->is_isotropic(); }
bool GoalField::is_order_free() const { return cones_->has_starts(); }
bool GoalField::jumps() const { return !cones_->is_isotropic() && !is_order_free(); }
std::span<const std::uint32_t> GoalField::kept() const { return cones_->isotropic().kept(); }
double GoalField::negligible() const { return negligible_for(target_); }

void GoalField::sample(std::span<const Point> x, std::span<Metric> out) const {
    cones_->evaluate(x, out, continuous_at(x));
}

double GoalField::departure_from_all(double delta) const {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    if (cones_->longer() == 1 || delta == infinity) return delta;
    if (delta == target_) return whole_target_;
    const double all = nonconformity_of_factor(largest_factor_within(delta) * cones_->longer());
    if (delta <= target_) return std::min(all, whole_target_);
    return std::max(all, std::nextafter(whole_target_, infinity));
}

std::vector<Metric> GoalField::continuous_at(std::span<const Point> x) const {
    if (!continuous_) return {};
    std::vector<Metric> own(x.size());
    continuous_->sample(x, own);
    return own;
}

void GoalField::forget_if_full() const { cache_->forget_if_full(); }

std::vector<Point> GoalField::probes(const Box& domain) const {
    constexpr std::uint64_t everywhere = 100000, near_sources = 100000;
    std::vector<Point> x;
    x.reserve(everywhere + near_sources);
    for (std::uint64_t k = 0; k < everywhere; ++k) x.push_back(place_in(domain, k));
    for (std::uint64_t k = 0; k < near_sources && !sources_.empty(); ++k) {
        const PointSource& source = sources_[k * sources_.size() / near_sources];
        const Vector reach = Vector::Constant(mean_length(source.metric));
        const Box around{source.position - reach, source.position + reach};
        x.push_back(nearest_in(domain, place_in(around, k)));
    }
    return x;
}

double GoalField::largest_departure(const Box& domain, const Sample& sample_space,
                                    const GrowthLimit& limit) const {
    const std::vector<Point> x = probes(domain);
    std::vector<Metric> own(x.size());
    std::vector<Metric> exact(x.size());
    sample_space(x, own);
    sample_parallel(UntilLate(*this, limit), x, exact);
    double largest = 0;
    for (std::size_t i = 0; i < x.size(); ++i) {
        largest = std::max(largest, directional_nonconformity(own[i], exact[i]));
    }
    return largest;
}

}  // namespace controlspace
