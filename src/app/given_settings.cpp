#include "app/given_settings.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>

#include "error.h"
#include "study/settings.h"

namespace controlspace {
namespace {

/// Words of the command line as a setting of `type` takes them; a word that is no number stays a
/// text, for the setting to refuse.
SettingValues values_of(ValueType type, const std::vector<std::string>& words) {
    SettingValues values;
    for (const std::string& word : words) {
        double x = 0;
        const char* end = word.data() + word.size();
        const auto read = std::from_chars(word.data(), end, x);
        if (type != ValueType::text && read.ec == std::errc() && read.ptr == end) {
            values.emplace_back(x);
        } else {
            values.emplace_back(word);
        }
    }
    return values;
}

/// Sets `key` where it is one of `settings`.
template <class Target>
void apply(std::span<const Setting<Target>> settings, Target& target, const std::string& key,
           const std::vector<std::string>& words) {
    for (const Setting<Target>& setting : settings) {
        if (setting.key != key) continue;
        try {
            set_checked(setting, target, values_of(setting.type, words));
        } catch (const InputError& error) {
            std::string option = key;
            std::replace(option.begin(), option.end(), '_', '-');
            throw InputError(fmt::format("--{}: {}", option, error.what()));
        }
    }
}

}  // namespace

void apply(const GivenSettings& settings, Study& study) {
    for (const auto& [key, words] : settings) {
        apply(study_settings(), study, key, words);
        for (Run& run : study.runs) apply(run_settings(), run, key, words);
    }
}

}  // namespace controlspace
