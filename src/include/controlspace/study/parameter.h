// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "controlspace/space/catalogue.h"
#include "controlspace/study/access.h"
#include "controlspace/study/case.h"

namespace controlspace {

/// The purpose of a parameter; a command has options for those that it uses.
enum class Use {
    making,    ///< the structure
    reading,   ///< files of sources
    results,   ///< name and place of the results
    accuracy,  ///< what is measured against the reference
    timing,    ///< other measurements, by `compare` only
};

/// What a parameter is about; the help lists them by it.
enum class Topic {
    sources,
    sizes,
    accuracy,
    structures,
    output,
    performance,
    fields,  ///< analytic ones to test with
    paper,   ///< its samples, and schemes for comparisons with it
};

/// To which targets a parameter applies: in words ("the sphere"), and as a condition; without one,
/// to all. A value other than the default where it does not apply is an error.
template <class Target>
struct AppliesTo {
    std::string what;
    std::function<bool(const Target&)> is_true_of;
};

/// One parameter: the row that drives the command line, study files, results and resuming.
template <class Target>
struct Parameter {
    std::string key;   ///< in study files and results; with '-' for '_' the option
    std::string unit;  ///< empty for a pure number or a text
    std::string help;  ///< one line
    Access<Target> access;
    Use use = Use::making;
    AppliesTo<Target> applies_to{};
    Topic topic = Topic::sources;

    bool applies(const Target& target) const {
        return !applies_to.is_true_of || applies_to.is_true_of(target);
    }
};

/// The part of a case that a parameter describes.
enum class Role {
    work,       ///< the requested field
    method,     ///< how it is approximated, for any structure
    structure,  ///< an option of some structures
};

/// A parameter of cases. Each value of its list in a run makes cases of its own.
struct CaseParameter : Parameter<Case> {
    Role role = Role::work;
    Values defaults = {};  ///< of a run; the one in a new Case comes first
    /// Part of the label of a setting or structure ("tau 0.5"); may be empty.
    std::function<std::string(const Case&)> label = {};
    /// Whether it has an effect on this structure; empty: on all. One that has none does not
    /// multiply the cases of a role of structures; where it was given, the rows say so.
    std::function<bool(const CatalogueEntry&, const Case&)> fits = {};
    std::string result_key = {};  ///< in rows of results; empty: `key`
    std::string same_as = {};     ///< the key whose value it sets in another form
    /// Nothing but another form of that value, which has no value of its own.
    bool is_form() const { return !same_as.empty() && defaults.empty(); }
    /// Effect on the options that structures are made with, for what is not a member of Case.
    std::function<void(const Case&, SpaceOptions&)> apply = {};
};

/// The key of the list of structures in a run, which is no parameter of a case.
inline constexpr const char* structures_key = "structures";

/// All parameters of the library. In expansion the first vary slowest; structures vary faster than
/// work and method, and slower than what is theirs.
std::span<const CaseParameter> case_parameters();

/// The same with these kinds of reference to choose from, the default first; in the library there
/// is the exact one. They must live as long as the rows.
std::vector<CaseParameter> case_parameters_with(std::span<const ReferenceKind* const> references);

/// A number that is kept in Case::other, for a parameter that is defined outside the library.
Access<Case> other_number(const std::string& key, Check check = any_number);

/// The values of a case, none where the parameter does not apply.
Values values_of(const CaseParameter& parameter, const Case& c);

/// "K_L s_L, all neighbours": the structure, and those of its options that are not the default.
std::string structure_label(const Case& c,
                            std::span<const CaseParameter> parameters = case_parameters());

/// The setting that the rows of one table share: "rho 1, s_a 2, s_n 1, g_r 1.25, exact reference,
/// cone law, queue, epsilon 0.2, tau 0.5", with "field ugawg-linear, " or "poisson sources, "
/// first.
std::string setting_label(const Case& c,
                          std::span<const CaseParameter> parameters = case_parameters());

/// The requested field: the part of the setting that has the role work.
std::string work_label(const Case& c,
                       std::span<const CaseParameter> parameters = case_parameters());

/// The structure, and the method where it is not the default: "K_L s_L, tau 0.5".
std::string method_label(const Case& c,
                         std::span<const CaseParameter> parameters = case_parameters());

}  // namespace controlspace
