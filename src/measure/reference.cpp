// SPDX-License-Identifier: Apache-2.0
#include "controlspace/measure/reference.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "cones/cone_field.h"
#include "controlspace/gradation/grade.h"
#include "controlspace/input_errors.h"
#include "controlspace/metric/intersection.h"
#include "controlspace/sources/cone.h"
#include "controlspace/space/control_space_builder.h"
#include "refuse.h"

namespace controlspace {

namespace {

void require_usable(const SourceColumns& sources, double g, const Metric& largest) {
    require_valid(GradationOptions{.ratio = g});
    if (!is_positive_definite(largest)) {
        refuse(
            "largest metric {} of the reference is not positive definite: "
            "give one with positive lengths",
            to_string(largest));
    }
    if (sources.size() >= std::numeric_limits<std::uint32_t>::max() / 2) {
        refuse("{} sources for the reference: give fewer than 2^31", sources.size());
    }
    for (std::size_t i = 0; i < sources.size(); ++i) {
        const PointSource& source = sources[i];
        if (!source.position.allFinite()) {
            throw IndexedError(i,
                               fmt::format("source {}: its position is not finite: correct it", i));
        }
        require_valid(source, i, Box::everywhere());
    }
}

class ExactReference final : public ControlSpace {
public:
    ExactReference(const SourceColumns& sources, double g, const Metric& largest, double tolerance,
                   IntersectionRule rule, std::shared_ptr<const ControlSpace> continuous)
        : field_(sources, g, largest, tolerance, rule), continuous_(std::move(continuous)) {}

    void sample(std::span<const Point> x, std::span<Metric> out) const override {
        std::vector<Metric> further;
        if (continuous_) {
            further.resize(x.size());
            continuous_->sample(x, further);
        }
        field_.evaluate(x, out, further);
    }

private:
    ConeField field_;
    std::shared_ptr<const ControlSpace> continuous_;
};

class BruteForceReference final : public ControlSpace {
public:
    BruteForceReference(std::vector<PointSource> sources, double g, const Metric& largest)
        : sources_(std::move(sources)), g_(g), largest_(largest) {
        smallest_.reserve(sources_.size());
        for (const PointSource& s : sources_) smallest_.push_back(eigen_frame(s.metric).lengths[0]);
    }

    void sample(std::span<const Point> x, std::span<Metric> out) const override {
        std::transform(x.begin(), x.end(), out.begin(), [this](const Point& p) { return at(p); });
    }

private:
    Metric at(const Point& p) const {
        std::vector<double> lengths(sources_.size());
        for (std::size_t i = 0; i < lengths.size(); ++i) {
            lengths[i] = cone_factor(sources_[i], g_, p) * smallest_[i];
        }
        std::vector<std::size_t> order(sources_.size());
        std::iota(order.begin(), order.end(), std::size_t{0});
        std::stable_sort(order.begin(), order.end(),
                         [&](std::size_t a, std::size_t b) { return lengths[a] < lengths[b]; });
        Metric m = largest_;
        for (const std::size_t i : order) {
            m = intersection(m, cone_factor(sources_[i], g_, p) * sources_[i].metric);
        }
        return m;
    }

    std::vector<PointSource> sources_;
    std::vector<double> smallest_;
    double g_;
    Metric largest_;
};

}  // namespace

std::unique_ptr<ControlSpace> exact_reference(const SourceColumns& sources, double g,
                                              const Metric& largest, double tolerance,
                                              IntersectionRule rule,
                                              std::shared_ptr<const ControlSpace> continuous) {
    require_usable(sources, g, largest);
    if (!std::isfinite(tolerance) || tolerance < 0) {
        refuse("tolerance {} of the reference: give a finite one >= 0", tolerance);
    }
    return std::make_unique<ExactReference>(sources, g, largest, tolerance, rule,
                                            std::move(continuous));
}

std::unique_ptr<ControlSpace> exact_reference(const std::vector<PointSource>& sources, double g,
                                              const Metric& largest, double tolerance,
                                              IntersectionRule rule,
                                              std::shared_ptr<const ControlSpace> continuous) {
    return exact_reference(columns_of(sources), g, largest, tolerance, rule, std::move(continuous));
}

std::unique_ptr<ControlSpace> brute_force_reference(std::vector<PointSource> sources, double g,
                                                    const Metric& largest) {
    require_usable(columns_of(sources), g, largest);
    return std::make_unique<BruteForceReference>(std::move(sources), g, largest);
}

}  // namespace controlspace
