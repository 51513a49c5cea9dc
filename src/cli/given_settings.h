#pragma once

#include <span>
#include <string>
#include <utility>
#include <vector>

#include "controlspace/error.h"
#include "study/settings.h"
#include "study/study.h"

namespace controlspace {

/// Settings of the command line by key, as they were written.
using GivenSettings = std::vector<std::pair<std::string, std::vector<std::string>>>;

/// Words of the command line as a setting of `type` takes them; a word that is no number stays a
/// text, for the setting to refuse.
SettingValues values_of(ValueType type, const std::vector<std::string>& words);

/// "--time-limit" for the key time_limit.
std::string option_name(std::string_view key);

/// Sets what is given in `target`, where it is one of `settings`. Throws InputError that names the
/// option.
template <class Target>
void apply(const GivenSettings& given, std::span<const Setting<Target>> settings, Target& target) {
    for (const auto& [key, words] : given) {
        for (const Setting<Target>& setting : settings) {
            if (setting.key != key) continue;
            try {
                set_checked(setting, target, values_of(setting.type, words));
            } catch (const InputError& error) {
                throw InputError(option_name(key) + ": " + error.what());
            }
        }
    }
}

/// Sets what is given in `study` and in all of its runs. Throws as above.
void apply(const GivenSettings& given, Study& study);

}  // namespace controlspace
