#include "cli/input_study.h"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "cli/formats.h"
#include "cli/options.h"
#include "cli/paper_reference.h"
#include "controlspace/baselines/catalogue.h"
#include "controlspace/error.h"
#include "controlspace/io/read_sources.h"
#include "controlspace/metric/nonconformity.h"

namespace controlspace {

namespace {

/// Before the others.
void add_file(const std::filesystem::path& file, SourcesChoice& sources) {
    std::vector<std::filesystem::path> files = files_of(sources);
    if (sources.kind != SourcesKind::file) {
        if (sources.primitives.empty() || sources.kind != SourcesKind::none) {
            throw InputError(fmt::format("--sources {} does not go with {}: leave one out",
                                         sources_name(sources), file.string()));
        }
        sources.kind = SourcesKind::file;
    }
    if (std::ranges::count(files, file) > 0) return;
    sources.file = file;
    sources.further_files = std::move(files);
}

}  // namespace

Study study_of_input(const std::filesystem::path& input, const GivenSettings& given) {
    Study study;
    if (input.extension() == ".toml") {
        study = read_study(input, program_parameters());
    } else {
        study.runs.front() = one_structure();
        if (!input.empty()) {
            study.sources.kind = SourcesKind::file;
            study.sources.file = input;
        }
    }
    const auto is_sources = [](const auto& setting) { return setting.first == "sources"; };
    const bool is_one_of_several = study.sources.kind == SourcesKind::file &&
                                   input.extension() != ".toml" &&
                                   std::ranges::any_of(given, is_sources);
    apply(given, study);
    if (is_one_of_several) add_file(input, study.sources);
    return study;
}

DefaultTarget::DefaultTarget(const std::filesystem::path& input, const GivenSettings& given)
    : applies_(input.extension() != ".toml") {
    for (const char* key : {"target_delta", "within", "field", "tau", "epsilon", "law", "schedule",
                            "neighbourhood", "reference"}) {
        const auto is_given = [&](const auto& setting) { return setting.first == key; };
        applies_ = applies_ && std::ranges::none_of(given, is_given);
    }
}

bool DefaultTarget::set(Case& c, std::span<const PointSource> sources) const {
    if (applies_ && has_field(c.sources)) return c.target_delta.has_value();  // by expand
    const auto is_length = [](const PointSource& s) { return is_isotropic(s.metric); };
    if (!applies_ || c.structure != "K_oV" || sources.empty() ||
        !std::ranges::all_of(sources, is_length)) {
        return false;
    }
    c.target_delta = nonconformity_of_factor(default_within);
    return true;
}

Case only_case(const Study& study) {
    const std::vector<Case> cases = expand(study, program_rows());
    if (cases.size() > 1) {
        throw InputError(fmt::format(
            "{} cases, the first two {} ({}) and {} ({}): choose one by --structures, --splits, "
            "--tau and so on",
            cases.size(), structure_label(cases[0]), setting_label(cases[0]),
            structure_label(cases[1]), setting_label(cases[1])));
    }
    require_set_voxels(cases.front());
    return cases.front();
}

void require_set_voxels(const Case& c) {
    if (!c.equal_delta && !c.equal_memory) return;
    throw InputError("equal_delta and equal_memory are for compare: give the voxel that it found");
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

void require_no_input(const std::filesystem::path& output,
                      const std::vector<std::filesystem::path>& inputs) {
    for (const std::filesystem::path& written : with_partner(output)) {
        std::error_code none;  // terminals and pipes are read and written alike
        if (!std::filesystem::is_regular_file(written, none)) continue;
        for (const std::filesystem::path& input : inputs) {
            for (const std::filesystem::path& read : with_partner(input)) {
                if (!std::filesystem::equivalent(written, read, none)) continue;
                throw InputError(fmt::format("{} is read: name another output", written.string()));
            }
        }
    }
}

std::vector<PointSource> sources_of_input(const std::filesystem::path& file,
                                          const GivenSettings& given) {
    Study study;
    apply(given, study_parameters(), study);
    study.sources.kind = SourcesKind::file;
    study.sources.file = file;
    require_applicable(study);
    return read_source_file(study.sources, file_readers());
}

}  // namespace controlspace
