#pragma once

#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "cli/given_settings.h"

namespace CLI {
class App;
}

namespace controlspace {

/// Words given for each setting, by key.
using WordsByKey = std::map<std::string_view, std::vector<std::string>>;

/// An option of a command as the help shows it.
struct OptionText {
    std::string name;   ///< "--samples", "-o,--output"; without dashes, an argument by its position
    std::string value;  ///< "FILE.ctrl"
    std::string help;   ///< one sentence, with the unit in brackets
    std::string group = {};  ///< heading in the help; empty: the command's own options
    bool required = false;
};

/// The options of one command. Values are set when the command line is parsed and must live until
/// then. Keeps the parser's header, which takes seconds to compile, out of the commands.
class Options {
public:
    explicit Options(CLI::App& command) : command_(&command) {}

    void add(const OptionText& text, bool& value);
    void add(const OptionText& text, double& value);
    void add(const OptionText& text, int& value);
    void add(const OptionText& text, std::filesystem::path& value);
    /// From 1 to `at_most` words; 0: any number, separated by commas.
    void add(const OptionText& text, std::vector<std::string>& values, std::size_t at_most);

    /// An option for each setting, except those `without`; the help shows the values of `defaults`.
    template <class Target>
    void add_settings(std::span<const Setting<Target>> settings, const Target& defaults,
                      const std::string& group, WordsByKey& given,
                      std::span<const std::string_view> without = {}) {
        for (const Setting<Target>& s : settings) {
            if (std::find(without.begin(), without.end(), s.key) != without.end()) continue;
            add_setting(s.key, s.type, s.at_most, s.help, s.get(defaults), group, given[s.key]);
            for (const Setting<Target>& other : settings) {
                const bool same =
                    other.same_as == s.key ||
                    (!s.same_as.empty() && (other.same_as == s.same_as || other.key == s.same_as));
                if (same && other.key != s.key && given.contains(other.key)) {
                    exclude(option_name(s.key), option_name(other.key));
                }
            }
        }
    }

    /// Refuses the two options together.
    void exclude(const std::string& name, const std::string& other);
    /// Replaces the text below the options, the exit statuses.
    void set_footer(const std::string& text);
    /// Names of the options of a group that were given. To be called once it is parsed.
    std::vector<std::string> given_of(const std::string& group) const;

private:
    void add_setting(std::string_view key, ValueType type, std::size_t at_most,
                     std::string_view help, const SettingValues& default_values,
                     const std::string& group, std::vector<std::string>& words);

    CLI::App* command_;
};

/// The settings of which words were given.
GivenSettings given_settings(const WordsByKey& given);

// Options that several commands share.

/// INPUT: a study file or a file of sources.
void add_study_input(Options& options, std::filesystem::path& input);

/// INPUT: the same, or a saved control space.
void add_filled_input(Options& options, std::filesystem::path& input);

void add_quiet(Options& options, bool& quiet);

/// The settings of a study that builds one structure, except those of its measurements, and
/// `another`.
void add_making_options(Options& options, WordsByKey& given, std::string_view another = {});

/// The settings of a study that say how files of sources are read.
void add_reading_options(Options& options, WordsByKey& given);

}  // namespace controlspace
