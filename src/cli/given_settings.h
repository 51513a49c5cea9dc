// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <utility>
#include <vector>

#include "controlspace/error.h"
#include "controlspace/study/study.h"

namespace controlspace {

/// Settings of the command line by key, as they were written.
using GivenSettings = std::vector<std::pair<std::string, std::vector<std::string>>>;

/// Words of the command line as values of `type`; a word that is no number remains a text, which
/// the setting refuses.
Values values_of(ValueType type, const std::vector<std::string>& words);

/// "--time-limit" for the key time_limit.
std::string option_name(std::string_view key);

/// Calls `set` with the values of `key`, if they are given. Throws InputError that names the
/// option.
template <class Set>
void if_given(const GivenSettings& given, const std::string& key, ValueType type, const Set& set) {
    for (const auto& [name, words] : given) {
        if (name != key) continue;
        try {
            set(values_of(type, words));
        } catch (const InputError& error) {
            throw InputError(option_name(key) + ": " + error.what());
        }
    }
}

/// Sets what is given in `target`, where it is one of `parameters`. Throws as above.
template <class Target>
void apply(const GivenSettings& given, std::span<const Parameter<Target>> parameters,
           Target& target) {
    for (const Parameter<Target>& p : parameters) {
        if_given(given, p.key, p.access.type,
                 [&](const Values& values) { set_checked(p.access, target, values); });
    }
}

/// Sets what is given in `study` and in all of its runs. Throws as above.
void apply(const GivenSettings& given, Study& study);

}  // namespace controlspace
