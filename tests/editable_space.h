// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <mutex>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "controlspace/space/catalogue.h"
#include "controlspace/space/control_nodes.h"
#include "controlspace/space/control_space_builder.h"
#include "controlspace/space/control_space_file.h"

namespace controlspace {

/// A builder with what it has built last, which is built anew when it is read after a change: tests
/// change and read in turn. Several threads may read at once.
class EditableSpace final : public ControlSpace, public HasControlNodes {
public:
    explicit EditableSpace(std::unique_ptr<ControlSpaceBuilder> builder)
        : builder_(std::move(builder)) {}

    ControlSpaceBuilder& builder() const { return *builder_; }
    const ControlSpace& built() const {
        const std::scoped_lock lock(reading_);
        if (!space_) space_ = builder_->build();
        return *space_;
    }

    void sample(std::span<const Point> x, std::span<Metric> out) const override {
        built().sample(x, out);
    }
    Box domain() const override { return builder_->domain(); }
    Footprint footprint() const override { return built().footprint(); }
    std::optional<Box> cell_at(const Point& x) const override { return built().cell_at(x); }
    ControlNodes control_nodes(Neighbourhood neighbourhood) const override {
        return controlspace::control_nodes(built(), neighbourhood).value();
    }
    double largest_gradation(Neighbourhood neighbourhood, GradationLaw law) const override {
        return controlspace::largest_gradation(built(), neighbourhood, law).value();
    }

    Insertion insert(const PointSource& source) { return changed().insert(source); }
    InsertionReport insert(std::span<const PointSource> sources) {
        return changed().insert(sources);
    }
    GradationReport grade(const GradationOptions& options) { return changed().grade(options); }
    AdaptationReport adapt(const AdaptationGoal& goal) { return changed().adapt(goal); }
    void assign(std::span<const Metric> metrics) {
        dynamic_cast<NodeBuilder&>(changed()).assign(metrics);
    }
    std::unique_ptr<ControlSpace> compact(Precision precision) const {
        return builder_->build({.precision = precision});
    }

private:
    ControlSpaceBuilder& changed() {
        space_.reset();
        return *builder_;
    }

    std::unique_ptr<ControlSpaceBuilder> builder_;
    mutable std::unique_ptr<ControlSpace> space_;
    mutable std::mutex reading_;
};

inline std::unique_ptr<EditableSpace> editable(std::unique_ptr<ControlSpaceBuilder> builder) {
    return std::make_unique<EditableSpace>(std::move(builder));
}
inline void save_control_space(const std::filesystem::path& file, const EditableSpace& space) {
    save_control_space(file, space.builder());
}
inline std::unique_ptr<EditableSpace> load_editable(const std::filesystem::path& file,
                                                    std::span<const CatalogueEntry> structures) {
    return editable(load_builder(file, structures));
}

inline std::vector<Metric> answers(const ControlSpace& space, std::span<const Point> x) {
    std::vector<Metric> out(x.size());
    space.sample(x, out);
    return out;
}

/// The tree called `id`.
inline const CatalogueEntry& tree_named(std::string_view id) {
    if (const CatalogueEntry* entry = find_entry(all_trees(), id)) return *entry;
    throw std::out_of_range("no tree is called " + std::string(id));
}
/// Answers by searching its sources, without any cells.
inline bool is_direct(const CatalogueEntry& entry) {
    return entry.has<KeptSources>() && !entry.has<SourceLeaves>();
}
/// Whether leaves or nodes carry metrics, or nothing does.
inline bool keeps_values(const CatalogueEntry& entry) {
    return !entry.has<KeptSources>() || is_direct(entry);
}
/// Whether it answers metrics that it was given only nearly.
inline bool is_rounding(const CatalogueEntry& entry) {
    const auto* nodes = entry.find<MetricNodes>();
    return nodes != nullptr && nodes->rounding > 1e-12;
}

}  // namespace controlspace
