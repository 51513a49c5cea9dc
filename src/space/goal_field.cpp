#include "space/goal_field.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "controlspace/error.h"
#include "controlspace/metric/intersection.h"
#include "controlspace/metric/nonconformity.h"
#include "controlspace/space/control_space_builder.h"
#include "controlspace/space/sample_parallel.h"
#include "controlspace/space/space_options.h"
#include "geometry/place_sequence.h"

namespace controlspace {

namespace {

const AdaptationGoal& require_valid(const AdaptationGoal& goal, const Box& domain) {
    require_valid(GradationOptions{.ratio = goal.ratio});
    if (!(goal.target > 0) || !std::isfinite(goal.target)) {
        throw InputError(
            fmt::format("target_delta is {}: give a positive non-conformity", goal.target));
    }
    for (std::size_t i = 0; i < goal.sources.size(); ++i) {
        controlspace::require_valid(goal.sources[i], i, domain);
    }
    return goal;
}

// Shortening of lengths that may be passed over: some hundredth of the target, as δ.
double negligible(double target) { return 0.1 * std::sqrt(target); }

}  // namespace

GoalField::GoalField(const AdaptationGoal& goal, const Box& domain)
    : target_(require_valid(goal, domain).target),
      ratio_(goal.ratio),
      sources_(goal.sources),
      continuous_(goal.continuous),
      largest_(largest_metric(domain)),
      cones_(goal.sources, goal.ratio, largest_, negligible(goal.target)) {}

void GoalField::sample(std::span<const Point> x, std::span<Metric> out) const {
    cones_.evaluate(x, out);
    add_continuous(x, out);
}

void GoalField::evaluate_here(std::span<const Point> x, std::span<Metric> out,
                              ConeField::Memory& memory) const {
    cones_.evaluate(x, out, memory);
    add_continuous(x, out);
}

void GoalField::evaluate_here(std::span<const Point> x, std::span<Metric> out,
                              const NearbyCones& nearby) const {
    for (std::size_t i = 0; i < x.size(); ++i) {
        out[i] = Metric::isotropic(nearby.smallest_length(x[i]));
    }
    add_continuous(x, out);
}

double GoalField::evaluate_roughly(std::span<const Point> x, std::span<Metric> out,
                                   ConeField::Memory& memory) const {
    if (!has_ranges()) {
        evaluate_here(x, out, memory);
        return 1;
    }
    cones_.evaluate_roughly(x, negligible(target_), out, memory);
    return 1 + negligible(target_);
}

void GoalField::add_continuous(std::span<const Point> x, std::span<Metric> out) const {
    if (!continuous_) return;
    std::vector<Metric> own(x.size());
    continuous_->sample(x, own);
    for (std::size_t i = 0; i < x.size(); ++i) out[i] = intersection(out[i], own[i]);
}

double GoalField::largest_departure(const Box& domain, const Sample& sample_space) const {
    constexpr std::uint64_t everywhere = 100000, near_sources = 100000;
    std::vector<Point> x;
    x.reserve(everywhere + near_sources);
    for (std::uint64_t k = 0; k < everywhere; ++k) x.push_back(place_in(domain, k));
    for (std::uint64_t k = 0; k < near_sources && !sources_.empty(); ++k) {
        const PointSource& source = sources_[k * sources_.size() / near_sources];
        const Vector reach = Vector::Constant(mean_length(source.metric));
        const Box around{source.position - reach, source.position + reach};
        x.push_back(place_in(around, k).cwiseMax(domain.low).cwiseMin(domain.high));
    }
    std::vector<Metric> own(x.size());
    std::vector<Metric> exact(x.size());
    sample_space(x, own);
    sample_parallel(*this, x, exact);
    double largest = 0;
    for (std::size_t i = 0; i < x.size(); ++i) {
        largest = std::max(largest, nonconformity(own[i], exact[i]));
    }
    return largest;
}

}  // namespace controlspace
