#pragma once

#include <memory>
#include <span>

#include "controlspace/error.h"
#include "controlspace/space/catalogue.h"
#include "controlspace/space/control_space_builder.h"

namespace controlspace {

/// The builder of a system that stores what a structure of ours holds: it fills that structure, and
/// `convert` makes the system's own form of it.
class ConvertedBuilder final : public ControlSpaceBuilder {
public:
    using Convert = std::unique_ptr<ControlSpace> (*)(const ControlSpace& ours);
    ConvertedBuilder(std::unique_ptr<ControlSpaceBuilder> ours, Convert convert)
        : ours_(std::move(ours)), convert_(convert) {}

    InsertionReport insert(std::span<const PointSource> sources) override {
        return ours_->insert(sources);
    }
    GradationReport grade(const GradationOptions& options) override {
        return ours_->grade(options);
    }
    AdaptationReport adapt(const AdaptationGoal& goal) override { return ours_->adapt(goal); }
    std::unique_ptr<ControlSpace> build(const BuildOptions& options) override {
        if (options.precision) throw InputError("a foreign system has no compact form");
        return convert_(*ours_->build());
    }
    Box domain() const override { return ours_->domain(); }

private:
    std::unique_ptr<ControlSpaceBuilder> ours_;
    Convert convert_;
};

}  // namespace controlspace
