// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include "controlspace/gradation/grade.h"
#include "controlspace/metric/stored_metric.h"
#include "controlspace/space/adaptation.h"
#include "controlspace/space/space_options.h"
#include "controlspace/space/split_words.h"
#include "controlspace/study/sources_choice.h"
#include "controlspace/study/value.h"

namespace controlspace {

class ControlSpace;
struct Case;
struct Study;
struct Workload;

/// A kind of field that δ_R is measured against.
struct ReferenceKind {
    std::string name;
    std::string meaning;
    std::function<std::shared_ptr<const ControlSpace>(const Study&, const Case&, const Workload&)>
        make;
    /// Throws InputError for sources that have no such field.
    std::function<void(const SourcesChoice&)> require_fit = [](const SourcesChoice&) {};
};

/// Intersection of all sources' cones (paper §5.2) and, as it stands, of the field.
const ReferenceKind& exact_reference_kind();

/// What a finished structure stores its values in (BuildOptions::precision).
enum class StoredIn { as_made, doubles, floats, log16, log8 };
StoredIn stored_in(Precision precision);
/// None of what is built as it was made, or has no choice.
std::optional<Precision> precision_of(std::optional<StoredIn> form);

/// Trees that are to follow a continuous field, or isotropic sources, without a target: the largest
/// factor between their lengths and those of the exact field.
inline constexpr double default_within = 1.1;
/// The same of sources with tensors, where it takes longer and stops at this many leaves.
inline constexpr double default_within_of_tensors = 1.2;
inline constexpr int default_max_leaves_of_tensors = 50'000;
/// Leaves at which adapted trees stop, unless told otherwise: some 0.6 GB while they are made.
inline constexpr int default_max_leaves = 2'000'000;

/// One structure under one setting, which gives one row of results. Its members are set by the rows
/// of case_parameters(). What does not apply to the structure is none, or has its default.
struct Case {
    std::string structure = "K_L";        ///< id in the catalogue
    std::optional<SplitRule> split = {};  ///< kd-trees only
    SourcesChoice sources = {};
    double tau = 1;        ///< l_min: longest edge of a source's leaf, in the source's metric
    double epsilon = 0.2;  ///< ε_δ of insertion
    double g_r = 1.25;     ///< gradation ratio
    std::optional<int> max_depth = {};       ///< trees only
    std::optional<double> voxel = {};        ///< grids only; none: by tau and the sources
    std::optional<double> prune_delta = {};  ///< OpenVDB only; none: nothing is pruned
    /// Adapted to this δ in place of insertion and gradation, a grid by its voxels; none: not
    /// adapted.
    std::optional<double> target_delta = {};
    /// Where the target was given as the largest factor between lengths in any direction.
    std::optional<double> within = {};
    /// Trees: leaves at which adaptation stops, though it misses its target; none: no limit.
    std::optional<std::size_t> max_leaves = {};
    /// Grids only: δ_R, or memory [MB], that voxels are chosen for.
    std::optional<double> equal_delta = {};
    std::optional<double> equal_memory = {};
    std::optional<QuadraticForm> interpolation = {};  ///< trees with quadratic leaves only
    std::optional<StoredIn> precision = {};           ///< structures with a choice of it only
    NodeValues values = NodeValues::field;            ///< adapted structures that can fit them only
    GradationLaw law = GradationLaw::cone;
    GradationSchedule schedule = GradationSchedule::sources;
    Neighbourhood neighbourhood = Neighbourhood::faces;  ///< structures that hold metrics only
    /// Of cones: in the exact reference, adaptation, and structures that keep sources.
    IntersectionRule intersection = IntersectionRule::order_free;
    const ReferenceKind* reference = &exact_reference_kind();
    /// Values of parameters that are defined outside the library, by key.
    std::map<std::string, Value> other = {};

    bool operator==(const Case&) const = default;
};

template <>
struct Words<GradationLaw> {
    static constexpr Word<GradationLaw> table[] = {
        {GradationLaw::cone, "cone", "h1 <= h0 + (g_r - 1) |v|, as in the exact reference"},
        {GradationLaw::mean_length, "mean-length",
         "the paper's: over the mean of both metric lengths"}};
};
template <>
struct Words<GradationSchedule> {
    static constexpr Word<GradationSchedule> table[] = {
        {GradationSchedule::sources, "sources", "the exact field of the sources at each node"},
        {GradationSchedule::queue, "queue", "from node to node until nothing changes"},
        {GradationSchedule::passes, "passes", "at most ten passes, as in the paper's tables"}};
};
template <>
struct Words<Neighbourhood> {
    static constexpr Word<Neighbourhood> table[] = {
        {Neighbourhood::faces, "faces", "nodes across faces, at vertices along edges"},
        {Neighbourhood::all, "all", "those across edges and corners too"}};
};
template <>
struct Words<IntersectionRule> {
    static constexpr Word<IntersectionRule> table[] = {
        {IntersectionRule::order_free, "order-free", "the largest metric within all cones"},
        {IntersectionRule::in_turn, "in-turn",
         "one cone after the other, as in the paper: depends on their order"}};
};
template <>
struct Words<QuadraticForm> {
    static constexpr Word<QuadraticForm> table[] = {
        {QuadraticForm::corrected, "corrected", "paper §3.1 with its coordinates put right"},
        {QuadraticForm::published, "published", "with the two errors of the paper's program"}};
};
template <>
struct Words<NodeValues> {
    static constexpr Word<NodeValues> table[] = {
        {NodeValues::field, "field", "the field's own values at the nodes"},
        {NodeValues::fitted, "fitted",
         "lengths fitted to the field around each node: fewer nodes keep the same target"}};
};
template <>
struct Words<StoredIn> {
    static constexpr Word<StoredIn> table[] = {
        {StoredIn::doubles, "double", "8 bytes a number: the bits that were computed"},
        {StoredIn::floats, "float", "4 bytes a number, rounded by 6e-8"},
        {StoredIn::log16, "log16",
         "lengths in 2 bytes, rounded by 1e-4; longest <= 4.9e5 shortest"},
        {StoredIn::log8, "log8",
         "lengths in 1 byte, rounded by half of 255 equal ratios from the shortest to the longest"},
        {StoredIn::as_made, "as-made",
         "as insertion and gradation leave it: metrics in doubles; takes later sources"}};
};

}  // namespace controlspace
