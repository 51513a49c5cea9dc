// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <concepts>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "controlspace/measure/access_time.h"
#include "controlspace/measure/accuracy.h"
#include "controlspace/measure/steepness.h"
#include "controlspace/space/control_space.h"
#include "controlspace/study/workload.h"

namespace controlspace {

/// How a structure was made, creation_repeats times with the same answers.
struct Creation {
    std::uint64_t sources_inserted = 0;  ///< sources that changed the structure
    std::vector<double> insert_s;        ///< making the structure and inserting all sources
    std::vector<double> gradation_s;     ///< with building the finished form
    /// All of it where a grid's voxels, which were searched for a target, are known; else none.
    std::vector<double> known_s = {};
    GradationReport gradation;
    std::string remark;     ///< "δ <= 0.1 everywhere: lengths within 1.27x"
    std::string shortfall;  ///< why a requested target was missed; empty where it was met
    /// The limit that ended the making: "at 60 s"; empty where none did. Such a row is not ranked.
    std::string stopped = {};
    /// The largest factor between lengths that the remark states; 0: none.
    double within = 0;
    double delta = 0;  ///< the δ that it states
};

/// The remark on a structure: its limitations, the δ reached, and why a target was missed.
std::string remark_on(const Creation& creation, const Footprint& footprint);

/// A finished structure of a study with its raw measurements, from which the rows of measures are
/// computed. The references are valid during the call.
struct Finished {
    std::size_t index = 0;  ///< of the case in the study, from 0
    const Study& study;
    const Case& setting;
    const Workload& workload;
    const ReferenceProbes& probes;
    const ControlSpace& space;
    Creation creation = {};
    Footprint footprint = {};
    Accuracy accuracy = {};         ///< δ_R at the coarse probes
    Accuracy accuracy_fine = {};    ///< δ_R at the fine probes
    double source_accuracy = 0;     ///< δ_S
    Steepness steepness = {};       ///< G_det and G_dir
    AccessTime access_random = {};  ///< at random places; these five of `answers()`
    AccessTime access_grid = {};    ///< at the coarse probes, x fastest
    AccessTime access_near = {};    ///< near the sources
    AccessTime access_single = {};  ///< at random places, one a call
    AccessTime access_walk = {};    ///< along walks, by a cursor
    /// Of metrics, where `answers()` are lengths; else empty.
    AccessTime access_metric_random = {};
    AccessTime access_metric_single = {};
    /// First case of its batch, whose structures were timed in turns.
    std::size_t access_batch = 0;

    /// What the access is timed of: lengths where all is isotropic.
    Answers answers() const { return has_tensors(workload) ? Answers::metrics : Answers::lengths; }
};

/// A value in a row of results: none where the measure does not apply.
using MeasuredValue =
    std::variant<std::monostate, double, std::int64_t, std::string, std::vector<double>>;

/// How a measure is shown in tables.
struct Column {
    std::string header;  ///< empty: not in tables
    std::string format;  ///< of the number times `scale`: "{:.2f} %"; of others "{}"
    double scale = 1;
};

/// One measure of a `Subject`: the row that drives its files (results.json in both directions and
/// results.csv; meshes.json) and its tables.
template <class Subject>
struct MeasureOf {
    std::string key;   ///< in files; empty: only in tables
    std::string unit;  ///< empty for pure numbers and texts
    std::function<MeasuredValue(const Subject&)> value;
    Column column = {};
    bool may_be_missing = false;  ///< in results of earlier programs
};
/// One of a structure of a study.
using Measure = MeasureOf<Finished>;

/// A row of the number that `place` in a part of the subject leads to: a member of that, its own
/// function, or any other. Of a part that is optional and missing, none.
template <class Subject, class Part, class Place>
MeasureOf<Subject> row_of(const char* key, Part Subject::*part, Place place, Column column = {},
                          const char* unit = "") {
    const auto number = [=](const auto& x) -> MeasuredValue {
        const auto found = std::invoke(place, x);
        if constexpr (std::integral<decltype(found)>) return static_cast<std::int64_t>(found);
        return static_cast<double>(found);
    };
    const auto value = [=](const Subject& subject) {
        if constexpr (requires { (subject.*part).has_value(); }) {
            return subject.*part ? number(*(subject.*part)) : MeasuredValue();
        } else {
            return number(subject.*part);
        }
    };
    return {key, unit, value, std::move(column)};
}

/// All measures of the library, in the order of columns.
std::span<const Measure> measures();

/// The rows of a sampled measure: its median as `key`, its quartiles as key_q1 and key_q3, and the
/// samples as key_samples; none of them where there are no samples.
std::vector<Measure> sampled_measure(const std::string& key, const std::string& unit,
                                     std::function<std::vector<double>(const Finished&)> samples,
                                     const Column& column);

/// Files of sampled fields, relative to the folder of results.
struct FieldFiles {
    Box domain;
    double z = 0;  ///< height of the slice; in a flat domain, its place across its axis
    std::string slice, probes, outlines, exact_slice, exact_probes;  ///< outlines may be empty
};

/// The outcome of one case: measures by key, or the reason why there are none.
struct Row {
    Case setting;
    std::size_t sources = 0;
    std::map<std::string, MeasuredValue> values;  ///< empty where there is an error
    std::string error;
    std::optional<FieldFiles> fields;
    double seconds = 0;  ///< that the case took

    bool is_measured() const { return error.empty(); }
    /// Whether it was measured, and no limit ended the making of its structure.
    bool is_ranked() const { return is_measured() && text("stopped").empty(); }
    /// Whether it was measured, and met the target that was requested.
    bool is_as_requested() const { return is_measured() && text("shortfall").empty(); }
    /// A number; NaN where there is none.
    double number(const std::string& key) const;
    /// A text; empty where there is none.
    std::string text(const std::string& key) const;
};

}  // namespace controlspace
