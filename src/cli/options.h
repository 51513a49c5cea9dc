// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "cli/given_settings.h"
#include "cli/help.h"

namespace CLI {  // NOLINT(readability-identifier-naming)
class App;
}

namespace controlspace {

using Uses = std::vector<Use>;
inline const Uses all_uses{Use::making, Use::reading, Use::results, Use::accuracy, Use::timing};

/// Words given for each parameter, by key.
using WordsByKey = std::map<std::string_view, std::vector<std::string>>;

/// What commands share: what they read and write, settings, and --quiet.
struct Job {
    std::filesystem::path input = {}, output = {};
    WordsByKey given = {};
    bool quiet = false;
};

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
    template <class Value>  // double, int, path
    void add(const OptionText& text, Value& value);
    /// From 1 to `at_most` words; 0: any number, separated by commas.
    void add(const OptionText& text, std::vector<std::string>& values, std::size_t at_most);

    /// An option for each parameter that has one of the `uses`, except `without`, in `group` or,
    /// where it is empty, under its topic; the help shows the values of `defaults`.
    template <class Target>
    void add_parameters(std::span<const Parameter<Target>> parameters, const Target& defaults,
                        const std::string& group, WordsByKey& given, const Uses& uses = all_uses,
                        std::string_view without = {}) {
        for (const Parameter<Target>& p : parameters) {
            if (std::ranges::count(uses, p.use) == 0 || p.key == without) continue;
            add_parameter(text_of(p.key, p.help, p.unit, p.access.choices,
                                  group.empty() ? heading(p.topic) : group),
                          p.access.type, p.access.at_most, p.access.get(defaults), given[p.key]);
        }
    }

    /// The structures, and an option for each parameter of cases and studies, under the heading of
    /// its topic; otherwise as above.
    void add_settings(const Run& cases, const Study& study, WordsByKey& given,
                      const Uses& uses = all_uses, std::string_view without = {});

    /// Refuses the two options together.
    void exclude(const std::string& name, const std::string& other);
    /// A note below the options, and another list of exit statuses than that of all commands.
    void set_note(std::string text) { note_ = std::move(text); }
    void set_statuses(std::string text) { statuses_ = std::move(text); }
    /// `examples`, the note and the exit statuses.
    void set_footer(const std::string& examples, const std::string& statuses);
    /// Names of the options of a group that were given. To be called once it is parsed.
    std::vector<std::string> given_of(const std::string& group) const;

private:
    static OptionText text_of(const std::string& key, const std::string& help,
                              const std::string& unit, const std::vector<Choice>& choices,
                              const std::string& group);
    void add_parameter(const OptionText& text, ValueType type, std::size_t at_most,
                       const Values& defaults, std::vector<std::string>& words);

    void add_case_parameters(const Run& defaults, WordsByKey& given, const Uses& uses,
                             std::string_view without);

    CLI::App* command_;
    std::string note_, statuses_;
};

/// The settings of which words were given.
GivenSettings given_settings(const WordsByKey& given);

// Options that several commands share.

/// INPUT: a study file or a file of sources.
void add_study_input(Options& options, std::filesystem::path& input);

/// INPUT: the same, or a saved control space.
void add_filled_input(Options& options, std::filesystem::path& input, bool required = false);

void add_quiet(Options& options, bool& quiet);

/// The parameters of a study that builds one structure, except those of its measurements, and
/// `another`; and --quiet.
void add_making_options(Options& options, Job& job, std::string_view another = {});
/// The structure of commands that make one, where none is given: K_oV, with the split s_L.
Run one_structure();

/// The settings of a study for reading files of sources; and --quiet.
void add_reading_options(Options& options, Job& job);

}  // namespace controlspace
