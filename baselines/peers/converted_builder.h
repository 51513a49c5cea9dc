// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <span>
#include <string>
#include <utility>

#include "controlspace/space/catalogue.h"
#include "controlspace/space/control_space_builder.h"
#include "refuse.h"

namespace controlspace {

/// The builder of a system that stores what a structure of ours holds: it fills that structure, of
/// which `Space` is made.
template <class Space>
class ConvertedBuilder final : public ControlSpaceBuilder {
public:
    explicit ConvertedBuilder(std::unique_ptr<ControlSpaceBuilder> ours) : ours_(std::move(ours)) {}

    using ControlSpaceBuilder::insert;
    InsertionReport insert(std::span<const PointSource> sources) override {
        return ours_->insert(sources);
    }
    InsertionReport insert(const SourceColumns& sources) override { return ours_->insert(sources); }
    GradationReport grade(const GradationOptions& options) override {
        return ours_->grade(options);
    }
    AdaptationReport adapt(const AdaptationGoal& goal) override { return ours_->adapt(goal); }
    std::unique_ptr<ControlSpace> build(const BuildOptions& options) override {
        if (options.precision) refuse_precision();
        return std::make_unique<Space>(*ours_->build());
    }
    Box domain() const override { return ours_->domain(); }

private:
    std::unique_ptr<ControlSpaceBuilder> ours_;
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
