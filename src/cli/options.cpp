// SPDX-License-Identifier: Apache-2.0
#include "cli/options.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <type_traits>

#include "cli/paper_reference.h"
#include "files/text_file.h"
#include "refuse.h"

namespace controlspace {
namespace {

/// What the help shows as an option's values: "NUMBER", "TEXT,...", "NUMBER x 3".
std::string type_name(ValueType type, std::size_t at_most) {
    const std::string name = type == ValueType::number         ? "NUMBER"
                             : type == ValueType::whole_number ? "COUNT"
                                                               : "TEXT";
    return at_most == 0   ? name + ",..."
           : at_most == 1 ? name
                          : fmt::format("{} x {}", name, at_most);
}

void describe(CLI::Option& option, const OptionText& text) {
    option.option_text(text.value)->required(text.required);
    if (!text.group.empty()) option.group(text.group);
}

/// "-" is standard output where a file is written, and standard input where one is read.
std::string stream_for_dash(const std::string& name) {
    if (name == "OUT" || name.ends_with("--output")) return "/dev/stdout";
    return name.starts_with('-') ? "-" : "/dev/stdin";
}

}  // namespace

void Options::add(const OptionText& text, bool& value) {
    CLI::Option* flag = command_->add_flag(text.name, value, text.help);
    if (!text.value.empty()) flag->option_text(text.value);
    if (!text.group.empty()) flag->group(text.group);
}

template <class Value>
void Options::add(const OptionText& text, Value& value) {
    CLI::Option& option = *command_->add_option(text.name, value, text.help);
    describe(option, text);
    if constexpr (std::is_same_v<Value, std::filesystem::path>) {
        option.transform([stream = stream_for_dash(text.name)](const std::string& file) {
            return file == "-" ? stream : file;
        });
    }
}
template void Options::add(const OptionText&, double&);
template void Options::add(const OptionText&, int&);
template void Options::add(const OptionText&, std::filesystem::path&);

void Options::add(const OptionText& text, std::vector<std::string>& values, std::size_t at_most) {
    CLI::Option* option = command_->add_option(text.name, values, text.help);
    describe(*option, text);
    // Lists are written with commas: with blanks they would swallow an argument that follows.
    if (at_most == 0) option->delimiter(',')->allow_extra_args(false);
    if (at_most > 0) option->expected(1, static_cast<int>(at_most));
}

OptionText Options::text_of(const std::string& key, const std::string& help,
                            const std::string& unit, const std::vector<Choice>& choices,
                            const std::string& group) {
    // Written by all commands, so that it has the short name everywhere.
    const std::string name = option_name(key);
    OptionText text{name == "--output" ? "-o," + name : name, "", help, group};
    for (const Choice& choice : choices) {
        text.help += (&choice == &choices.front() ? "; one of " : ", ") + choice.name;
    }
    if (!unit.empty()) text.help += fmt::format(" [{}]", unit);
    return text;
}

void Options::add_parameter(const OptionText& text, ValueType type, std::size_t at_most,
                            const Values& defaults, std::vector<std::string>& words) {
    const std::string default_text =
        defaults.empty() ? "" : fmt::format(" (default: {})", to_string(defaults));
    if (type == ValueType::flag) {
        command_
            ->add_flag_callback(
                text.name, [&words] { words = {"true"}; }, text.help)
            ->group(text.group);
        return;
    }
    CLI::Option* option = command_->add_option(text.name, words, text.help + default_text);
    option->group(text.group)->option_text(type_name(type, at_most));
    if (at_most > 1) {
        // No more, as a file's name may follow.
        option->delimiter(',')->expected(static_cast<int>(at_most))->allow_extra_args(false);
    } else {
        option->allow_extra_args(false);  // given_settings() splits it
    }
}

void Options::add_case_parameters(const Run& defaults, WordsByKey& given, const Uses& uses,
                                  std::string_view without) {
    const std::string key = structures_key;
    add_parameter(text_of(key,
                          "Structures (see `controlspace list`), or all, trees, further, "
                          "anchored, baselines",
                          "", {}, heading(Topic::structures)),
                  ValueType::text, 0, defaults.structures(), given[structures_key]);
    std::vector<const CaseParameter*> forms;  // in several forms of one value
    for (const CaseParameter& p : program_parameters()) {
        if (std::ranges::count(uses, p.use) == 0 || p.key == without) continue;
        add_parameter(text_of(p.key, p.help, p.unit, p.access.choices, heading(p.topic)),
                      p.access.type, 0, defaults.values(p), given[p.key]);
        for (const CaseParameter* other : forms) {
            if (p.same_as == other->key || (!p.same_as.empty() && p.same_as == other->same_as)) {
                exclude(option_name(p.key), option_name(other->key));
            }
        }
        forms.push_back(&p);
    }
}

void Options::add_settings(const Run& cases, const Study& study, WordsByKey& given,
                           const Uses& uses, std::string_view without) {
    add_parameters(study_parameters(), study, "", given, uses, without);
    add_case_parameters(cases, given, uses, without);
}

void Options::exclude(const std::string& name, const std::string& other) {
    command_->get_option(name)->excludes(command_->get_option(other));
}

void Options::set_footer(const std::string& examples, const std::string& statuses) {
    std::string text = examples.empty() ? "" : fmt::format("Examples:\n{}\n", examples);
    if (!note_.empty()) text += note_ + "\n\n";
    command_->footer(text + (statuses_.empty() ? statuses : statuses_));
}

std::vector<std::string> Options::given_of(const std::string& group) const {
    std::vector<std::string> names;
    for (const CLI::Option* option : command_->get_options()) {
        if (option->count() > 0 && option->get_group() == group) {
            names.push_back(option->get_name());
        }
    }
    return names;
}

GivenSettings given_settings(const WordsByKey& given) {
    GivenSettings settings;
    for (const auto& [key, words] : given) {
        if (words.empty()) continue;
        std::vector<std::string> all;
        for (const std::string& word : words) {
            const auto items = split(word, ',');  // CLI11 would leave out empty ones
            if (items.size() > 1 && std::ranges::count(items, "") > 0) {
                refuse("{} {}: a comma without a value: leave it out", option_name(key), word);
            }
            all.insert(all.end(), items.begin(), items.end());
        }
        settings.emplace_back(key, std::move(all));
    }
    return settings;
}

void add_study_input(Options& options, std::filesystem::path& input) {
    options.add({"INPUT", "FILE",
                 "Study file (.toml), or sources: files, or another value of --sources; left out: "
                 "the paper's sphere"},
                input);
}

void add_filled_input(Options& options, std::filesystem::path& input, bool required) {
    options.add(
        {"INPUT", "FILE",
         std::string("Study file (.toml), control space (.ctrl, .pctrl), or sources: files, or "
                     "another value of --sources") +
             (required ? "" : "; left out: the paper's sphere"),
         "", required},
        input);
}

void add_quiet(Options& options, bool& quiet) {
    options.add({"--quiet", "", "No progress on standard error"}, quiet);
}

Run one_structure() { return {{structures_key, {"K_oV"}}, {"splits", {"s_L"}}}; }

void add_making_options(Options& options, Job& job, std::string_view another) {
    options.set_note(
        "Without tau, epsilon, law, schedule or a target, K_oV is adapted until lengths are within "
        "1.1x of the exact field's, with tensors 1.2x, in 50000 leaves at most (--max-leaves); "
        "--target-delta 0: inserted and graded.");
    options.add_settings(one_structure(), Study{}, job.given, {Use::making, Use::reading}, another);
    add_quiet(options, job.quiet);
}

void add_reading_options(Options& options, Job& job) {
    options.add_parameters(study_parameters(), Study{}, "", job.given, {Use::reading});
    add_quiet(options, job.quiet);
}

}  // namespace controlspace
