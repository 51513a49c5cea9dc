// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "controlspace/geometry/box.h"
#include "controlspace/space/catalogue.h"
#include "controlspace/study/case.h"
#include "controlspace/study/parameter.h"

namespace controlspace {

struct Finished;
template <class Subject>
struct MeasureOf;
using Measure = MeasureOf<Finished>;
std::span<const Measure> measures();

/// The rows of a study. Programs may add their own to those of the library.
struct StudyRows {
    std::span<const CatalogueEntry> structures;
    std::span<const CaseParameter> parameters = case_parameters();
    std::span<const Measure> measures = controlspace::measures();
};

/// Lists of values by the keys of parameters, whose product gives cases; without a list, a
/// parameter has its default. What does not apply to a structure (a split to an octree) does not
/// multiply it.
class Run {
public:
    Run() = default;
    Run(std::initializer_list<std::pair<const std::string, Values>> lists) : lists_(lists) {}

    /// Unchecked access: names of structures, or values of a parameter.
    Values& operator[](const std::string& key) { return lists_[key]; }
    /// Null where there is none.
    const Values* find(const std::string& key) const;
    /// The list of the parameter, or its defaults.
    const Values& values(const CaseParameter& parameter) const;
    /// Ids, or families and "all"; {"all"} by default.
    Values structures() const;

    /// Throws InputError for values that the parameter does not have. A parameter that is another
    /// form of one sets that one.
    void set(const CaseParameter& parameter, const Values& values,
             std::span<const CaseParameter> all = case_parameters());
    /// The same for the structures.
    void set_structures(const Values& names);

private:
    std::map<std::string, Values> lists_;
};

/// A comparison: one kind of sources, one domain, one way to measure, and the runs.
struct Study {
    std::string name = "study";
    SourcesChoice sources;  ///< sampling, rho, s_a, s_n and the kind of field come from the runs
    /// None: where the field is defined; where that is everywhere, and for sampled surfaces,
    /// [-1, 1]^3; else from the sources.
    std::optional<Box> domain;
    double margin = 0.05;       ///< around sources from a file, in units of their longest extent
    double max_memory_gib = 4;  ///< cap on a structure
    /// A row is stopped after so many seconds of making its structure, and at so many times the
    /// memory of the smallest row of the same sources before it (see RowLimits); 0: not.
    double max_seconds = 0;
    double max_memory_ratio = 0;
    std::uint64_t seed = 1;  ///< of the random places that access is timed at, and of sources
    int threads = 0;         ///< for all but the access, which is timed on one; 0: all
    std::size_t access_points = 100000;  ///< random places
    int access_repeats = 9;
    int creation_repeats = 3;
    int probe_grid = 30;        ///< n of the n^3 cell centres for δ_R, and for access in order
    int fine_probe_grid = 101;  ///< n of the finer ones
    double reference_tolerance = 0;  ///< see exact_reference (measure/reference.h)
    std::string output;              ///< folder; empty: results/NAME-DATE-TIME
    std::vector<Run> runs{Run{}};
};

/// Parameters of a study as a whole.
std::span<const Parameter<Study>> study_parameters();

/// Throws InputError for a parameter of the study that does not apply, as to other sources, and
/// whose value is not the default.
void require_applicable(const Study& study);

/// All cases of a study, each once, in the order of the runs. Throws InputError as
/// require_applicable, for a structure that is not in the catalogue, for parameters of the sources
/// that do not apply, for a reference that does not fit the sources, and for a study without cases.
std::vector<Case> expand(const Study& study, const StudyRows& rows);

/// The parameters that runs with the structure of `c` give another value than the defaults, and
/// that have no effect on it: "target_delta (within)".
std::vector<std::string> settings_without_effect(const Study& study, const Case& c,
                                                 const StudyRows& rows);

/// Reads a study file (TOML). Keys of `study_parameters` are at the top; keys of case parameters in
/// tables [[runs]], or at the top for all runs that do not set them. A value may stand alone or in
/// an array; arrays of a run expand to the product of cases. Files of sources are searched beside
/// the study file. Without a name the study has that of its file.
///
/// Throws InputError "FILE:LINE: ..." for what is not TOML, unknown keys, and values of a wrong
/// type, number or range.
Study read_study(const std::filesystem::path& file,
                 std::span<const CaseParameter> parameters = case_parameters());

/// The same from `text`; `place` stands for the file in messages and in the paths of sources.
Study parse_study(std::string_view text, const std::filesystem::path& place,
                  std::span<const CaseParameter> parameters = case_parameters());

}  // namespace controlspace
