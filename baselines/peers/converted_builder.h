// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <memory>
#include <span>
#include <string>
#include <utility>

#include "controlspace/metric/nonconformity.h"
#include "controlspace/space/catalogue.h"
#include "controlspace/space/control_space_builder.h"
#include "refuse.h"

namespace controlspace {

/// The builder of a system that stores what a structure of ours holds: it fills that structure, of
/// which `Space` is made. Space::rounding() is the largest factor between its lengths and those of
/// ours, usual_rounding a guess before it is made; 1 where nothing is rounded.
template <class Space>
class ConvertedBuilder final : public ControlSpaceBuilder {
public:
    explicit ConvertedBuilder(std::unique_ptr<ControlSpaceBuilder> ours) : ours_(std::move(ours)) {}

    using ControlSpaceBuilder::insert;
    InsertionReport insert(std::span<const PointSource> sources) override {
        return changed().insert(sources);
    }
    InsertionReport insert(const SourceColumns& sources) override {
        return changed().insert(sources);
    }
    GradationReport grade(const GradationOptions& options) override {
        return changed().grade(options);
    }
    AdaptationReport adapt(const AdaptationGoal& goal) override {
        return Space::usual_rounding > 1 ? adapt_before_rounding(goal) : changed().adapt(goal);
    }
    std::unique_ptr<ControlSpace> build(const BuildOptions& options) override {
        if (options.precision) refuse_precision();
        if (made_) return std::move(made_);
        return std::make_unique<Space>(*ours_->build());
    }
    Box domain() const override { return ours_->domain(); }

private:
    // To less than the target, by the factor that rounding then takes, which is known only of what
    // was made.
    AdaptationReport adapt_before_rounding(const AdaptationGoal& goal) {
        constexpr int rounds = 4;
        const double allowed = largest_factor_within(goal.target);
        double rounding = Space::usual_rounding;
        AdaptationReport report;
        for (int round = 0; round < rounds; ++round) {
            if (!(rounding < allowed)) {
                refuse("rounding by a factor of {:.4g} cannot keep a target of {}: raise it",
                       rounding, goal.target);
            }
            AdaptationGoal own = goal;
            own.target = nonconformity_of_factor(allowed / rounding);
            report = changed().adapt(own);
            made_ = std::make_unique<Space>(*ours_->build());
            const double taken = made_->rounding();
            const bool was_met = report.met;
            report.reached = nonconformity_of_factor(largest_factor_within(report.reached) * taken);
            // But for the rounding of these factors.
            if (was_met && taken <= rounding)
                report.reached = std::min(report.reached, goal.target);
            report.met = was_met && report.reached <= goal.target;
            if (report.met || !was_met) return report;
            rounding = 1 + 1.1 * (taken - 1);
        }
        report.shortfall = "rounding takes more than was left for it";
        return report;
    }
    ControlSpaceBuilder& changed() {
        made_.reset();
        return *ours_;
    }

    std::unique_ptr<ControlSpaceBuilder> ours_;
    std::unique_ptr<Space> made_;  // of them, where its rounding was measured
};

/// The row of a system that `Space` makes of what `Space::ours(options)` builds.
template <class Space>
CatalogueEntry converted_row(const std::string& id, const std::string& description) {
    return {.id = id,
            .description = description,
            .construct = [](const SpaceOptions& options) -> std::unique_ptr<ControlSpaceBuilder> {
                return std::make_unique<ConvertedBuilder<Space>>(Space::ours(options));
            },
            .capabilities = {SourceLeaves()}};
}

}  // namespace controlspace
