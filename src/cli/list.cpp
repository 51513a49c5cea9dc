// SPDX-License-Identifier: Apache-2.0
// The command `list`: structures, and other values of options.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <memory>

#include "cli/command.h"
#include "cli/given_settings.h"
#include "cli/options.h"
#include "cli/paper_reference.h"
#include "cli/standard_output.h"
#include "controlspace/baselines/catalogue.h"
#include "controlspace/study/parameter.h"

namespace controlspace {
namespace {

std::string section(const std::string& title, const std::vector<Choice>& entries) {
    std::size_t width = 0;
    for (const Choice& entry : entries) width = std::max(width, entry.name.size());
    std::string text = title + "\n";
    for (const Choice& entry : entries) {
        text += fmt::format("  {:{}}  {}\n", entry.name, width, entry.meaning);
    }
    return text;
}

std::string list_text() {
    std::vector<Choice> entries;
    for (const CatalogueEntry& entry : structures())
        entries.push_back({entry.id, entry.description});
    std::string text = section("Structures (--structures)", entries);
    for (const CaseParameter& p : program_parameters()) {
        if (p.access.choices.empty()) continue;
        text += section(fmt::format("\n{} ({})", p.help.substr(0, p.help.find_first_of(":;")),
                                    option_name(p.key)),
                        p.access.choices);
    }
    return text;
}

}  // namespace

Action add_list(Options& options) {
    const auto job = std::make_shared<Job>(Job{.output = "/dev/stdout"});
    options.add({"-o,--output", "FILE", "File to write; left out: standard output"}, job->output);
    add_quiet(options, job->quiet);
    return [job](const std::string&) {
        print_to(job->output, list_text());
        return 0;
    };
}

}  // namespace controlspace
