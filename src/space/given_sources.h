// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "controlspace/gradation/grade.h"
#include "controlspace/gradation/ordered_metrics.h"
#include "controlspace/metric/metric.h"
#include "controlspace/sources/point_source.h"
#include "controlspace/sources/source_columns.h"
#include "controlspace/space/adaptation.h"
#include "controlspace/space/control_space.h"
#include "controlspace/space/space_options.h"
#include "space/state.h"

namespace controlspace {

/// Gradation ratios of sources in a `.ctrl` file: the array "NAME.growths", if any has one. Throws
/// InputError where they are not sound, or not as many as `sources`.
void save_growths(StateWriter& state, std::string_view name, const OwnGrowths& growths);
OwnGrowths load_growths(const StateReader& state, std::string_view name, std::size_t sources);

/// Sources, as arrays "NAME.positions" and so on.
void save(StateWriter& state, std::string_view name, const SourceColumns& sources);
/// Throws InputError where they are not sound.
SourceColumns load_sources(const StateReader& state, std::string_view name);
bool has_sources(const StateReader& state, std::string_view name);

/// What a builder was given, as far as it keeps that: from it the field is built again where
/// sources come later (SpaceOptions::takes_later_sources).
struct Given {
    /// All sources; with a `base`, those that came after it. None where they are not known.
    std::optional<SourceColumns> sources = {};
    /// What it was adapted to, but for the sources; its spans are empty.
    std::optional<AdaptationGoal> goal = {};
    std::vector<Point> places = {};  ///< of the goal
    /// The state of a field that was assigned, or loaded without its sources.
    std::shared_ptr<const std::string> base = {};
    bool is_inserted = true;  ///< nothing but one insertion of all sources has changed the field

    std::size_t bytes() const;
    AdaptationGoal goal_of(std::span<const PointSource> all) const;
};

/// The sources and, where sources may come later, the rest. A continuous field cannot be saved: the
/// sources beside it are left out.
void save(StateWriter& state, const Given& given, bool takes_later);
/// Throws InputError where it is not sound, but for the base.
Given load_given(const StateReader& state);

/// Throws InputError if a source has a gradation ratio of its own: where the sources before it are
/// not known, nodes are graded one by the other.
void require_alike_growth(std::span<const PointSource> sources);

/// How a builder grades its control nodes: by the exact field of the sources it was given, or else
/// by the law, from node to node.
struct NodeGradation {
    /// `given`: all sources that the builder was given, whether they changed it or not; null where
    /// they are not known. Throws InputError as require_valid(options) does,
    /// and for sources with ratios of their own if they are not to be graded by the exact field.
    NodeGradation(const GradationOptions& options, const SourceColumns* given,
                  const SpaceOptions& space);
    /// By the exact field of `given`.
    NodeGradation(double ratio, std::span<const PointSource> given, const SpaceOptions& space);

    GradationOptions options;  ///< `schedule` is `sources` only with a field
    std::unique_ptr<const ControlSpace> field;
    double largest_ratio;  ///< of all cones
};

/// Sets control nodes at `x` to the field, but intersects them with it where it is more than twice
/// as long as what they request, on all of TBB's threads.
GradationReport grade_to(const ControlSpace& field, std::span<const Point> x,
                         OrderedMetrics metrics);

}  // namespace controlspace
