#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "controlspace/space/catalogue.h"
#include "controlspace/study/access.h"
#include "controlspace/study/case.h"

namespace controlspace {

/// What a parameter is for; commands offer what they use.
enum class Use {
    making,    ///< the structure
    reading,   ///< files of sources
    results,   ///< name and place of the results
    accuracy,  ///< what is measured against the reference
    timing,    ///< what else only `compare` measures
};

/// What a parameter applies to ("the sphere"), and whether that is so of a target; to everything
/// without a function. A value other than the default where it does not apply is an error.
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

    bool applies(const Target& target) const {
        return !applies_to.is_true_of || applies_to.is_true_of(target);
    }
};

/// What a parameter of cases says of them.
enum class Role {
    work,       ///< the field that is asked for
    method,     ///< how any structure answers it
    structure,  ///< a choice that only some structures have
};

/// A parameter of cases. Each value of its list in a run makes cases of its own.
struct CaseParameter : Parameter<Case> {
    Role role = Role::work;
    Values defaults = {};  ///< of a run; the one in a new Case comes first
    /// Part of the label of a setting or structure ("tau 0.5"); may be empty.
    std::function<std::string(const Case&)> label = {};
    /// Of a role of structures: whether it applies to this one.
    std::function<bool(const CatalogueEntry&, const Case&)> fits = {};
    std::string result_key = {};  ///< in rows of results; empty: `key`
    std::string same_as = {};     ///< the key whose value it sets in another form
    /// Effect on the options that structures are made with, for what is not a member of Case.
    std::function<void(const Case&, SpaceOptions&)> apply = {};
};

/// The key of the list of structures in a run, which is no parameter of a case.
inline constexpr const char* structures_key = "structures";

/// All parameters of the library. In expansion the first vary slowest; structures vary faster than
/// work and method, and slower than what is theirs.
std::span<const CaseParameter> case_parameters();

/// A number that is kept in Case::other, for a parameter that is defined outside the library.
Access<Case> other_number(const std::string& key, Check check = any_number);

/// The values of a case, none where the parameter does not apply.
Values values_of(const CaseParameter& parameter, const Case& c);

/// "K_L s_L, all neighbours": the structure, and what is its own where that is not the default.
std::string structure_label(const Case& c,
                            std::span<const CaseParameter> parameters = case_parameters());

/// What rows of one table share: "rho 1, s_a 2, s_n 1, g_r 1.25, exact reference, cone law, queue,
/// epsilon 0.2, tau 0.5", with "field ugawg-linear, " or "poisson sources, " first.
std::string setting_label(const Case& c,
                          std::span<const CaseParameter> parameters = case_parameters());

/// What is asked for, however it is answered: of the setting what has the role work.
std::string work_label(const Case& c,
                       std::span<const CaseParameter> parameters = case_parameters());

/// The structure, and the method where it is not the default: "K_L s_L, tau 0.5".
std::string method_label(const Case& c,
                         std::span<const CaseParameter> parameters = case_parameters());

}  // namespace controlspace
