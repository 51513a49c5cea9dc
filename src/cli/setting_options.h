#pragma once

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "cli/given_settings.h"

namespace controlspace {

/// Words given for each setting, by key.
using WordsByKey = std::map<std::string_view, std::vector<std::string>>;

/// The settings of which words were given.
GivenSettings given_settings(const WordsByKey& given);

/// What the help shows as an option's values: "NUMBER", "TEXT,...", "NUMBER x 3".
std::string type_name(ValueType type, std::size_t at_most);

/// Adds an option for each setting, but those `without`; `defaults` shows in the help.
template <class Target>
void add_options(CLI::App& command, std::span<const Setting<Target>> settings,
                 const Target& defaults, const std::string& group, WordsByKey& given,
                 std::span<const std::string_view> without = {}) {
    const auto is_left_out = [&](const Setting<Target>& setting) {
        return std::find(without.begin(), without.end(), setting.key) != without.end();
    };
    for (const Setting<Target>& setting : settings) {
        if (is_left_out(setting)) continue;
        std::string help(setting.help);
        const SettingValues values = setting.get(defaults);
        if (!values.empty()) help += fmt::format(" (default: {})", to_string(values));
        CLI::Option* option =
            command.add_option(option_name(setting.key), given[setting.key], help);
        // Lists are written with commas: with blanks they would swallow the study file.
        option->delimiter(',')->group(group);
        option->option_text(type_name(setting.type, setting.at_most));
        if (setting.at_most > 1) {
            option->expected(static_cast<int>(setting.at_most));
        } else {
            option->allow_extra_args(false);
        }
    }
    for (const Setting<Target>& setting : settings) {
        for (const Setting<Target>& other : settings) {
            const bool related = other.same_as == setting.key ||
                                 (!other.same_as.empty() && other.same_as == setting.same_as);
            if (!related || other.key == setting.key) continue;
            command.get_option(option_name(other.key))
                ->excludes(command.get_option(option_name(setting.key)));
        }
    }
}

/// The argument INPUT: what study_of_input takes.
void add_study_input(CLI::App& command, std::filesystem::path& input);

/// The same, or a control space that was saved.
void add_filled_input(CLI::App& command, std::filesystem::path& input);

/// All settings of a study that makes one structure, without those of measuring it; nor `another`,
/// which the command has for something else.
void add_making_options(CLI::App& command, WordsByKey& given, std::string_view another = {});

}  // namespace controlspace
