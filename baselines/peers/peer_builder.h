// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "controlspace/input_errors.h"
#include "controlspace/space/catalogue.h"
#include "controlspace/space/control_space_builder.h"
#include "refuse.h"
#include "space/goal_field.h"

namespace controlspace {

/// What a foreign system is built from: all sources at once, and the options, whose `ratio` and
/// `h_max` are those of gradation.
struct PeerInput {
    SpaceOptions options;
    std::vector<PointSource> sources;

    /// No length is longer: see largest_metric.
    double longest() const { return largest_metric(options).xx; }
};

using MakePeer = std::unique_ptr<ControlSpace> (*)(const PeerInput& input);

/// Whether a system stores whole metrics or one length at a place.
enum class PeerValue { length, metric };

/// The builder of a foreign system: keeps the sources, and lets `make` do the rest. `grade` sets
/// the ratio; the law between sources is the system's own, whatever GradationOptions requests.
class PeerBuilder final : public ControlSpaceBuilder {
public:
    PeerBuilder(const SpaceOptions& options, MakePeer make, PeerValue value)
        : input_{options, {}}, make_(make), value_(value) {
        require_valid(options);
    }

    using ControlSpaceBuilder::insert;
    InsertionReport insert(std::span<const PointSource> sources) override {
        for (std::size_t i = 0; i < sources.size(); ++i) append(sources[i], i);
        return {sources.size(), sources.size()};
    }
    GradationReport grade(const GradationOptions& options) override {
        require_valid(options);
        input_.options.ratio = options.ratio;
        return {};
    }
    AdaptationReport adapt(const AdaptationGoal& goal) override {
        if (goal.continuous) {
            refuse("this system is built from point sources: give no field that is continuous");
        }
        AdaptationGoal bounded = goal;
        bounded.h_max = std::min(input_.options.h_max, goal.h_max);
        const GoalField wanted(bounded, domain());
        input_.options.h_max = bounded.h_max;
        input_.options.ratio = goal.ratio;
        input_.sources.clear();
        insert(goal.sources);
        const auto space = make_(input_);
        AdaptationReport report;
        report.reached = wanted.largest_departure(
            domain(), [&](auto x, auto metrics) { space->sample(x, metrics); });
        report.met = report.reached <= goal.target;
        if (!report.met) report.shortfall = "this system has no setting that brings it closer";
        return report;
    }
    std::unique_ptr<ControlSpace> build(const BuildOptions& options) override {
        if (options.precision) refuse_precision();
        return make_(input_);
    }
    Box domain() const override { return input_.options.domain; }

private:
    void append(const PointSource& source, std::size_t index) {
        require_valid(source, index, domain());
        if (value_ == PeerValue::length && !is_isotropic(source.metric)) {
            throw IndexedError(index,
                               "source " + std::to_string(index) +
                                   ": this system stores one length at a place, no tensor: "
                                   "give isotropic sources, or leave it out of --structures");
        }
        input_.sources.push_back(source);
    }

    PeerInput input_;
    MakePeer make_;
    PeerValue value_;
};

/// The row of a system that `make` makes; `order` of its interpolation.
template <MakePeer make, PeerValue value>
CatalogueEntry peer_row(const std::string& id, const std::string& description, int order) {
    return {.id = id,
            .description = description,
            .order = order,
            .construct = [](const SpaceOptions& options) -> std::unique_ptr<ControlSpaceBuilder> {
                return std::make_unique<PeerBuilder>(options, make, value);
            },
            .capabilities = {KeptSources()}};
}

/// A finished system that answers lengths: `lengths` is all that it has to provide.
class LengthSpace : public ControlSpace {
public:
    explicit LengthSpace(const Box& domain) : domain_(domain) {}

    void sample(std::span<const Point> x, std::span<Metric> out) const final {
        for_each_batch(x, [&](std::size_t first, std::span<const double> h) {
            for (std::size_t i = 0; i < h.size(); ++i) out[first + i] = Metric::isotropic(h[i]);
        });
    }
    void sample_lengths(std::span<const Point> x, std::span<double> out) const final {
        for_each_batch(x, [&](std::size_t first, std::span<const double> h) {
            std::ranges::copy(h, out.begin() + static_cast<std::ptrdiff_t>(first));
        });
    }
    Box domain() const final { return domain_; }

protected:
    /// Lengths at places inside the domain, some at a time.
    virtual void lengths(std::span<const Point> x, std::span<double> out) const = 0;

private:
    template <class Take>
    void for_each_batch(std::span<const Point> x, const Take& take) const {
        constexpr std::size_t most = 128;
        std::array<Point, most> inside;
        std::array<double, most> h;
        for (std::size_t first = 0; first < x.size(); first += most) {
            const std::size_t count = std::min(most, x.size() - first);
            for (std::size_t i = 0; i < count; ++i) {
                inside[i] = nearest_in(domain_, x[first + i]);
            }
            lengths({inside.data(), count}, {h.data(), count});
            take(first, {h.data(), count});
        }
    }

    Box domain_;
};

}  // namespace controlspace
