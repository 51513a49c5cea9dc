#pragma once

#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "study/study.h"

namespace controlspace {

/// A value as it stands in an option or a study file.
using SettingValue = std::variant<double, std::string>;
using SettingValues = std::vector<SettingValue>;

enum class ValueType { number, whole_number, text };

/// One thing that can be set, by the same key in study files and, with '-' for '_', as an option.
template <class Target>
struct Setting {
    std::string_view key;
    /// Of each value; `set` may rely on it.
    ValueType type;
    /// How many values: from 1 to at_most; 0 is any number from 1.
    std::size_t at_most;
    /// The key whose value it sets too, in another form; of such keys one alone may be given.
    std::string_view same_as;
    /// One line with the unit.
    std::string_view help;
    /// Throws InputError with what is wrong and what would be right; the caller adds the place.
    void (*set)(Target&, const SettingValues&);
    /// The value that stands; empty for a key that is another form of one.
    SettingValues (*get)(const Target&);
};

/// Keys of a study as a whole.
std::span<const Setting<Study>> study_settings();

/// Keys of a run; each takes a list.
std::span<const Setting<Run>> run_settings();

/// "1, 0.5", for help texts.
std::string to_string(const SettingValues& values);

/// Throws InputError unless `values` are of the type, and from 1 to `at_most` (0: any number).
void require_fit(ValueType type, std::size_t at_most, const SettingValues& values);

/// Sets what fits the setting's type and number; throws InputError for what does not.
template <class Target>
void set_checked(const Setting<Target>& setting, Target& target, const SettingValues& values) {
    require_fit(setting.type, setting.at_most, values);
    setting.set(target, values);
}

}  // namespace controlspace
