// SPDX-License-Identifier: Apache-2.0
#include "cli/input_study.h"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "cli/formats.h"
#include "cli/options.h"
#include "cli/paper_reference.h"
#include "controlspace/io/read_sources.h"
#include "controlspace/metric/nonconformity.h"
#include "files/output_file.h"
#include "refuse.h"

namespace controlspace {

namespace {

/// Of an input and of --sources: all of both.
void add_sources(const SourcesChoice& input, SourcesChoice& sources) {
    const auto may_join = [](const SourcesChoice& choice) {
        return choice.kind == SourcesKind::file ||
               (choice.kind == SourcesKind::none && !choice.primitives.empty());
    };
    if (!may_join(input) || !may_join(sources)) {
        refuse("--sources {} does not go with {}: leave one out", sources_name(sources),
               sources_name(input));
    }
    const auto add_new = [](auto& all, const auto& more) {
        for (const auto& one : more) {
            if (std::ranges::count(all, one) == 0) all.push_back(one);
        }
    };
    if (input.kind == SourcesKind::file) {
        std::vector<std::filesystem::path> files = input.files;  // before the others
        add_new(files, sources.files);
        sources.kind = SourcesKind::file;
        sources.files = std::move(files);
    }
    add_new(sources.primitives, input.primitives);
}

}  // namespace

bool are_given(const GivenSettings& given, std::initializer_list<const char*> keys) {
    return std::ranges::any_of(given, [&](const auto& setting) {
        return std::ranges::find(keys, setting.first) != keys.end();
    });
}

void set_sources(Study& study, const std::filesystem::path& input) {
    std::error_code none;
    if (std::filesystem::exists(input, none) && !std::filesystem::is_directory(input, none)) {
        study.sources.kind = SourcesKind::file;
        study.sources.files = {input};
        return;
    }
    apply(given_settings({{"sources", {input.string()}}}), study_parameters(), study);
    if (study.sources.kind != SourcesKind::file) return;
    for (const std::filesystem::path& file : study.sources.files) {
        // Of a name with an ending, its reader tells what is wrong.
        if (file.has_extension() || std::filesystem::exists(file, none)) continue;
        std::vector<std::string_view> names;
        for (const auto& word : Words<SourcesKind>::table) names.push_back(word.name);
        refuse("there is no file '{}', and it names no sources: give a file, or one of {}",
               file.string(), fmt::join(names, ", "));
    }
}

void apply_with_input(const std::filesystem::path& input, const GivenSettings& given,
                      Study& study) {
    if (!input.empty()) set_sources(study, input);
    const SourcesChoice of_input = study.sources;
    apply(given, study);
    const auto is_sources = [](const auto& setting) { return setting.first == "sources"; };
    if (!input.empty() && std::ranges::any_of(given, is_sources)) {
        add_sources(of_input, study.sources);
    }
}

Study study_of_input(const std::filesystem::path& input, const GivenSettings& given) {
    Study study;
    if (input.extension() == ".toml") {
        study = read_study(input, program_parameters());
        apply(given, study);
    } else {
        study.runs.front() = one_structure();
        apply_with_input(input, given, study);
    }
    return study;
}

DefaultTarget::DefaultTarget(const std::filesystem::path& input, const GivenSettings& given)
    : is_free_(input.extension() != ".toml" && !are_given(given, {"target_delta", "within"})),
      applies_(is_free_ && !are_given(given, {"field", "tau", "epsilon", "law", "schedule",
                                              "neighbourhood", "reference"})) {
    if (!is_free_) return;
    if_given(given, "max_leaves", ValueType::whole_number, [&](const Values& values) {
        Case asked;
        set_checked(number<Case>(&Case::max_leaves, at_least(0)), asked, values);
        max_leaves_ = asked.max_leaves;
    });
}

double default_within_of(const Workload& workload) {
    return has_tensors(workload) ? default_within_of_tensors : default_within;
}

// Structures that a command makes where none is given, of a .vdb too.
static bool is_default(const std::string& structure) {
    return structure == "K_oV" || find_entry(structures(), structure)->has<VdbFiles>();
}

void DefaultTarget::set(Case& c, const Workload& workload) const {
    const bool follows_field = has_field(c.sources);  // by default, as expand sets it
    if (follows_field ? !is_free_ || !c.target_delta
                      : !applies_ || !is_default(c.structure) || workload.sources.empty()) {
        return;
    }
    c.within = default_within_of(workload);
    c.target_delta = nonconformity_of_factor(*c.within);
    c.max_leaves = max_leaves_.value_or(has_tensors(workload) ? default_max_leaves_of_tensors
                                                              : default_max_leaves);
    if (c.max_leaves == 0) c.max_leaves.reset();
}

Case only_case(const Study& study) {
    const std::vector<Case> cases = expand(study, program_rows());
    if (cases.size() > 1) {
        refuse(
            "{} cases, the first two {} ({}) and {} ({}): choose one by --structures, --splits, "
            "--tau and so on",
            cases.size(), structure_label(cases[0]), setting_label(cases[0]),
            structure_label(cases[1]), setting_label(cases[1]));
    }
    require_set_voxels(cases.front());
    return cases.front();
}

void require_set_voxels(const Case& c) {
    if (!c.equal_delta && !c.equal_memory) return;
    refuse("equal_delta and equal_memory are for compare: give the voxel that it found");
}

namespace {

// The file, and the one that belongs to it.
std::vector<std::filesystem::path> with_partner(const std::filesystem::path& file) {
    constexpr std::pair<const char*, const char*> pairs[] = {{".mesh", ".sol"},
                                                             {".meshb", ".solb"}};
    const std::string ending = lower_case_extension(file);
    std::filesystem::path partner = file;
    for (const auto& [mesh, solution] : pairs) {
        if (ending == mesh) return {file, partner.replace_extension(solution)};
        if (ending == solution) return {file, partner.replace_extension(mesh)};
    }
    return {file};
}

}  // namespace

void require_output(const std::filesystem::path& output,
                    const std::vector<std::filesystem::path>& inputs) {
    for (const std::filesystem::path& written : with_partner(output)) {
        std::error_code none;  // terminals and pipes are read and written alike
        if (!std::filesystem::is_regular_file(written, none)) continue;
        for (const std::filesystem::path& input : inputs) {
            for (const std::filesystem::path& read : with_partner(input)) {
                if (!std::filesystem::equivalent(written, read, none)) continue;
                refuse("{} is read: name another output", written.string());
            }
        }
    }
    if (!output.empty()) require_writable(output);
}

std::vector<PointSource> sources_of_input(const std::filesystem::path& input,
                                          const GivenSettings& given) {
    Study study;
    study.runs.front() = one_structure();
    set_sources(study, input);
    apply(given, study_parameters(), study);
    require_applicable(study);
    if (!study.sources.primitives.empty()) {
        refuse("{} is no set of points: give it to build, export or compare",
               to_string(study.sources.primitives.front()));
    }
    if (study.sources.kind == SourcesKind::file) {
        return read_source_file(study.sources, file_readers());
    }
    return make_workload(study, only_case(study).sources, file_readers()).sources.all();
}

std::vector<std::filesystem::path> files_named(const std::filesystem::path& input) {
    Study study;
    if (!input.empty() && input.extension() != ".toml") set_sources(study, input);
    std::vector<std::filesystem::path> files = input_files_of(study.sources);
    if (files.empty()) files.push_back(input);
    return files;
}

}  // namespace controlspace
