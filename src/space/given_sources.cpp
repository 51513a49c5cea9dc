// SPDX-License-Identifier: Apache-2.0
#include "space/given_sources.h"

#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "cones/cone_field.h"
#include "controlspace/input_errors.h"
#include "controlspace/metric/intersection.h"
#include "controlspace/sources/cone.h"
#include "geometry/threads.h"

namespace controlspace {

namespace {

class SourceField final : public ControlSpace {
public:
    template <class Sources>
    SourceField(const Sources& given, double ratio, const SpaceOptions& space)
        : cones_(given, ratio, largest_metric(space), tolerance, space.intersection) {}

    void sample(std::span<const Point> x, std::span<Metric> out) const override {
        cones_.evaluate(x, out);
    }

private:
    static constexpr double tolerance = 1e-2;  // of tensors: see ConeField

    ConeField cones_;
};

std::string column(std::string_view name, std::string_view of) {
    return fmt::format("{}.{}", name, of);
}

}  // namespace

void save_growths(StateWriter& state, std::string_view name, const OwnGrowths& growths) {
    if (!growths.empty()) state(column(name, "growths"), growths.values());
}

OwnGrowths load_growths(const StateReader& state, std::string_view name, std::size_t sources) {
    const std::string growths = column(name, "growths");
    std::vector<double> values;
    if (!state.has(growths)) return {};
    state(growths, values);
    state.require(values.size() == sources, growths, "has another length than the sources");
    state.require(all_are(values, is_source_growth), growths, "holds what is no ratio");
    return OwnGrowths(std::move(values));
}

void save(StateWriter& state, std::string_view name, const SourceColumns& sources) {
    state(column(name, "positions"), sources.positions());
    state(column(name, "lengths"), sources.lengths());
    state(column(name, "metrics"), sources.metrics());
    save_growths(state, name, sources.growths());
}

bool has_sources(const StateReader& state, std::string_view name) {
    return state.has(column(name, "positions"));
}

SourceColumns load_sources(const StateReader& state, std::string_view name) {
    const auto get = [&](std::string_view of, auto& values, const auto& holds,
                         std::string_view fault) {
        const std::string full = column(name, of);
        state(full, values);
        state.require(all_are(values, holds), full, fault);
    };
    const auto is_place = [](const Point& x) { return std::ranges::all_of(x, is_coordinate); };
    std::vector<Point> positions;
    std::vector<double> lengths;
    std::vector<Metric> metrics;
    get("positions", positions, is_place, "holds what is no place");
    get("lengths", lengths, is_length, "holds what is no length");
    get("metrics", metrics, is_source_metric, "holds what is no metric");
    const std::size_t count = positions.size();
    state.require(lengths.size() + metrics.size() == count && (lengths.empty() || metrics.empty()),
                  column(name, "positions"), "has another length than the metrics");
    return {std::move(positions), std::move(lengths), std::move(metrics),
            load_growths(state, name, count)};
}

std::size_t Given::bytes() const {
    return (sources ? sources->bytes() : 0) + places.capacity() * sizeof(Point) +
           (base ? base->capacity() : 0);
}

AdaptationGoal Given::goal_of(std::span<const PointSource> all) const {
    AdaptationGoal complete = *goal;
    complete.sources = all;
    complete.places = places;
    return complete;
}

namespace {

constexpr std::string_view sources_name = "given";
constexpr std::string_view base_name = "given.base";
constexpr std::string_view is_inserted_name = "given.is_inserted";
constexpr std::string_view places_name = "goal.places";
constexpr std::string_view values_name = "goal.values";

template <class Goal, class State>
void exchange(Goal& goal, State& state) {
    state("goal.ratio", goal.ratio);
    state("goal.target", goal.target);
    state("goal.intersection", goal.intersection, IntersectionRule::in_turn);
    state("goal.h_max", goal.h_max);
    state("goal.precision", goal.precision, Precision::log8);
    state("goal.max_leaves", goal.max_leaves);
}

}  // namespace

void save(StateWriter& state, const Given& given, bool takes_later) {
    if (!given.sources || (given.goal && given.goal->continuous)) return;
    save(state, sources_name, *given.sources);
    if (!takes_later) return;
    state(is_inserted_name, given.is_inserted);
    if (given.base) state(base_name, *given.base);
    if (!given.goal) return;
    exchange(*given.goal, state);
    if (given.goal->values != NodeValues::field) {
        state(values_name, given.goal->values, NodeValues::fitted);
    }
    state(places_name, given.places);
}

Given load_given(const StateReader& state) {
    Given given;
    given.is_inserted = false;
    if (!has_sources(state, sources_name)) return given;
    given.sources = load_sources(state, sources_name);
    if (state.has(is_inserted_name)) state(is_inserted_name, given.is_inserted);
    if (state.has(base_name)) {
        std::string base;
        state(base_name, base);
        given.base = std::make_shared<const std::string>(std::move(base));
    }
    if (state.has(places_name)) {
        exchange(given.goal.emplace(), state);
        if (state.has(values_name)) {
            state(values_name, given.goal->values, NodeValues::fitted);
        }
        state(places_name, given.places);
        require_valid(GradationOptions{.ratio = given.goal->ratio});
        state.require(given.goal->target > 0, "goal.target", "is no target");
        state.require(is_length(given.goal->h_max), "goal.h_max", "is no length");
    }
    return given;
}

void require_alike_growth(std::span<const PointSource> sources) {
    for (std::size_t i = 0; i < sources.size(); ++i) {
        if (sources[i].growth == 0) continue;
        throw IndexedError(
            i, fmt::format("source {} has a gradation ratio of its own, {}: insert such sources "
                           "before the structure is adapted, assigned or saved, or adapt it anew",
                           i, sources[i].growth));
    }
}

NodeGradation::NodeGradation(const GradationOptions& wanted, const SourceColumns* given,
                             const SpaceOptions& space)
    : options(wanted), largest_ratio(wanted.ratio) {
    require_valid(options);
    if (options.schedule == GradationSchedule::sources && given != nullptr &&
        options.law == GradationLaw::cone) {
        field = std::make_unique<SourceField>(*given, options.ratio, space);
        largest_ratio = std::max(options.ratio, largest_growth(*given, options.ratio));
        return;
    }
    if (given != nullptr && !given->growths().empty()) {
        throw InputError(
            "sources have gradation ratios of their own: grade by the cone law, with the schedule "
            "`sources`");
    }
    if (options.schedule == GradationSchedule::sources) options.schedule = GradationSchedule::queue;
}

NodeGradation::NodeGradation(double ratio, std::span<const PointSource> given,
                             const SpaceOptions& space)
    : options{.ratio = ratio}, largest_ratio(std::max(ratio, largest_growth(given, ratio))) {
    require_valid(options);
    field = std::make_unique<SourceField>(given, ratio, space);
}

GradationReport grade_to(const ControlSpace& field, std::span<const Point> x,
                         OrderedMetrics metrics) {
    // Cells larger than the elements that sources in them request keep the request.
    constexpr double too_coarse = 2;
    // Long blocks: places next to each other share a search. At least some for each thread.
    const std::size_t block =
        std::clamp<std::size_t>(x.size() / (8 * threads_allowed()), 64, 16384);
    const auto lower = [&](std::size_t first, std::vector<Metric>& exact) {
        const auto part = x.subspan(first, std::min(block, x.size() - first));
        exact.resize(part.size());
        field.sample(part, exact);
        std::uint64_t operations = 0;
        for (std::size_t k = 0; k < part.size(); ++k) {
            Metric& own = metrics[first + k];
            const Metric graded =
                is_within(exact[k], too_coarse, own) ? exact[k] : intersection(own, exact[k]);
            if (own != graded) ++operations;
            own = graded;
        }
        return operations;
    };
    using Range = tbb::blocked_range<std::size_t>;
    GradationReport report;
    report.operations = tbb::parallel_reduce(
        Range(0, (x.size() + block - 1) / block, 1), std::uint64_t{0},
        [&](const Range& range, std::uint64_t operations) {
            std::vector<Metric> exact;
            for (std::size_t i = range.begin(); i < range.end(); ++i) {
                operations += lower(i * block, exact);
            }
            return operations;
        },
        std::plus<>());
    return report;
}

}  // namespace controlspace
