// SPDX-License-Identifier: Apache-2.0
// The command `export`: writes the field of one structure to a file.
#include "cli/export.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <memory>

#include "cli/command.h"
#include "cli/standard_output.h"
#include "controlspace/io/read_sources.h"
#include "controlspace/io/write_vtk.h"
#include "refuse.h"

namespace controlspace {
namespace {

struct ExportJob : Job {
    int samples = 0;
    std::vector<FieldFormat> formats;
};

bool has_group(const FieldFormat& format, const std::string& group) {
    return std::ranges::count(format.groups, group) > 0;
}

/// Of the formats that have the group; of all formats where it is empty.
std::vector<std::string> endings_of(const std::vector<FieldFormat>& formats,
                                    const std::string& group = "") {
    std::vector<std::string> endings;
    for (const FieldFormat& format : formats) {
        if (!group.empty() && !has_group(format, group)) continue;
        endings.insert(endings.end(), format.endings.begin(), format.endings.end());
    }
    return endings;
}

std::string all_endings(const std::vector<FieldFormat>& formats) {
    std::vector<std::string> endings = endings_of(formats);
    std::ranges::sort(endings);
    return fmt::format("{}", fmt::join(endings, ", "));
}

/// The format of the output; refuses options of others.
const FieldFormat& chosen_format(const ExportJob& job, const Options& options) {
    const std::string ending = lower_case_extension(job.output);
    const auto chosen = std::ranges::find_if(job.formats, [&](const FieldFormat& format) {
        return std::ranges::count(format.endings, ending) > 0;
    });
    for (const FieldFormat& format : job.formats) {
        for (const std::string& group : format.groups) {
            const auto given = options.given_of(group);
            if (given.empty() || (chosen != job.formats.end() && has_group(*chosen, group))) {
                continue;
            }
            std::vector<std::string> endings = endings_of(job.formats, group);
            const std::string last = endings.back();
            endings.pop_back();
            refuse("{} is for {}{}{}: leave it out", given.front(), fmt::join(endings, ", "),
                   endings.empty() ? "" : " and ", last);
        }
    }
    if (chosen == job.formats.end()) {
        refuse_at(job.output, "name a file of one of {}", all_endings(job.formats));
    }
    return *chosen;
}

int export_field(const ExportJob& job, const Options& options, const std::string& command_line) {
    const FieldFormat& format = chosen_format(job, options);
    std::optional<int> samples;
    if (!options.given_of(samples_group).empty()) samples = job.samples;
    format.check(job.output, samples);
    std::string what;
    const FilledSpace filled =
        filled_space(job, "sampling and writing", [&](const auto& made, auto& progress) {
            what = format.write({job.input, job.output, command_line, made, progress, samples});
        });
    print(what);
    return report_remark(filled);
}

}  // namespace

std::string written(const Export& e, const std::string& what,
                    std::span<const std::filesystem::path> files) {
    std::error_code none;  // a pipe has no size
    std::uintmax_t bytes = 0;
    if (files.empty()) files = {&e.output, 1};
    for (const std::filesystem::path& file : files) {
        bytes += std::filesystem::file_size(file, none);
        if (none) break;
    }
    const std::string size =
        none ? "" : fmt::format("; {:.3g} MB", static_cast<double>(bytes) / 1e6);
    return fmt::format("{}: {}{}\n", e.output.string(), what, size);
}

Action add_export(Options& options) {
    const auto job = std::make_shared<ExportJob>();
    for (const auto add : {add_text_formats, add_size_formats, add_vdb_formats, add_vtk_formats}) {
        for (FieldFormat& format : add(options)) job->formats.push_back(std::move(format));
    }
    options.add(
        {"--samples", "COUNT",
         fmt::format(
             "Samples along the longest edge (default: {} of a .vti, .npy or .nc, {} of others)",
             Slice{}.samples, grid_samples),
         samples_group},
        job->samples);
    add_filled_input(options, job->input);
    options.add(
        {"-o,--output", "FILE",
         "File to write; its ending names the format: " + all_endings(job->formats), "", true},
        job->output);
    // --voxel is the file's, not that of a grid that is exported.
    add_making_options(options, *job, "voxel");
    return [job, &options](const std::string& command_line) {
        return export_field(*job, options, command_line);
    };
}

}  // namespace controlspace
