#include "controlspace/space/detail/given_sources.h"

#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <functional>

#include "cones/cone_field.h"
#include "controlspace/input_errors.h"
#include "controlspace/metric/intersection.h"
#include "geometry/threads.h"

namespace controlspace {

namespace {

class SourceField final : public ControlSpace {
public:
    SourceField(const GivenSources& given, double ratio, const SpaceOptions& space)
        : cones_(given.all(), ratio, largest_metric(space), tolerance, space.intersection) {}

    void sample(std::span<const Point> x, std::span<Metric> out) const override {
        cones_.evaluate(x, out);
    }

private:
    static constexpr double tolerance = 1e-2;  // of tensors: see ConeField

    ConeField cones_;
};

}  // namespace

void GivenSources::add(std::span<const PointSource> sources) {
    const auto is_isotropic = [](const PointSource& s) {
        return controlspace::is_isotropic(s.metric);
    };
    const bool are_lengths = metrics_.empty() && std::ranges::all_of(sources, is_isotropic);
    if (!are_lengths && metrics_.empty()) {
        for (const double h : lengths_) metrics_.push_back(Metric::isotropic(h));
        lengths_ = {};
    }
    for (std::size_t i = 0; i < sources.size(); ++i) growths_.add(size() + i, sources[i].growth);
    const auto append = [&](auto& values, auto member) {
        const auto first = static_cast<std::ptrdiff_t>(values.size());
        values.resize(values.size() + sources.size());
        std::ranges::transform(sources, values.begin() + first, member);
    };
    append(positions_, [](const PointSource& s) { return s.position; });
    if (are_lengths) {
        append(lengths_, [](const PointSource& s) { return s.metric.xx; });
    } else {
        append(metrics_, [](const PointSource& s) { return s.metric; });
    }
}

std::vector<PointSource> GivenSources::all() const {
    std::vector<PointSource> sources;
    sources.reserve(size());
    for (std::size_t i = 0; i < size(); ++i) {
        sources.push_back({positions_[i],
                           metrics_.empty() ? Metric::isotropic(lengths_[i]) : metrics_[i],
                           growths_[i]});
    }
    return sources;
}

double GivenSources::largest_growth(double g) const {
    double largest = g;
    for (std::size_t i = 0; i < size(); ++i) largest = std::max(largest, growths_[i]);
    return largest;
}

std::size_t GivenSources::bytes() const {
    return positions_.capacity() * sizeof(Point) + lengths_.capacity() * sizeof(double) +
           metrics_.capacity() * sizeof(Metric) + growths_.bytes();
}

void GivenSources::save(StateWriter& state) const {
    state("given.positions", positions_);
    state("given.lengths", lengths_);
    state("given.metrics", metrics_);
    growths_.save(state, "given.growths");
}

bool GivenSources::are_in(const StateReader& state) { return state.has("given.positions"); }

void GivenSources::load(const StateReader& state) {
    state("given.positions", positions_);
    state("given.lengths", lengths_);
    state("given.metrics", metrics_);
    state.require(
        lengths_.size() + metrics_.size() == size() && (lengths_.empty() || metrics_.empty()),
        "given.positions", "has another length than the metrics");
    growths_.load(state, "given.growths", size());
    const auto is_place = [](const Point& x) { return x.allFinite(); };
    const auto is_length = [](double h) { return h > 0 && std::isfinite(h); };
    state.require(all_are(positions_, is_place), "given.positions", "holds what is no place");
    state.require(all_are(lengths_, is_length), "given.lengths", "holds what is no length");
    require_metrics(state, "given.metrics", metrics_);
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

NodeGradation::NodeGradation(const GradationOptions& wanted, const GivenSources* given,
                             const SpaceOptions& space)
    : options(wanted), largest_ratio(wanted.ratio) {
    require_valid(options);
    if (options.schedule == GradationSchedule::sources && given != nullptr &&
        options.law == GradationLaw::cone) {
        field = std::make_unique<SourceField>(*given, options.ratio, space);
        largest_ratio = given->largest_growth(options.ratio);
        return;
    }
    if (given != nullptr && !given->all_grow_alike()) {
        throw InputError(
            "sources have gradation ratios of their own: grade by the cone law, with the schedule "
            "`sources`");
    }
    if (options.schedule == GradationSchedule::sources) options.schedule = GradationSchedule::queue;
}

GradationReport grade_to(const ControlSpace& field, std::span<const Point> x,
                         OrderedMetrics metrics) {
    // Cells larger than the elements that sources in them request keep the request.
    constexpr double too_coarse = 2;
    // Long blocks: a search remembers the last place. At least some for each thread.
    const std::size_t block = std::clamp<std::size_t>(x.size() / (8 * threads_allowed()), 64, 2048);
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
