// SPDX-License-Identifier: Apache-2.0
// The command `compare`: runs a study.
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

#include "cli/command.h"
#include "cli/filled_space.h"
#include "cli/folder_lock.h"
#include "cli/formats.h"
#include "cli/input_study.h"
#include "cli/options.h"
#include "cli/paper_reference.h"
#include "cli/progress.h"
#include "cli/signals.h"
#include "cli/standard_output.h"
#include "cli/threads.h"
#include "controlspace/error.h"
#include "controlspace/study/results.h"
#include "controlspace/study/run.h"
#include "refuse.h"
#include "study/forecast.h"
#include "study/text_table.h"

namespace controlspace {
namespace {

/// The settings given override the study file in all of its runs.
struct Compare : Job {
    bool as_published = false;
    std::filesystem::path resume;  ///< folder of an interrupted run to continue, or empty
    bool dry_run = false;          ///< list the cases instead of running them
};

// Where a user's file is compared, not a study: no row keeps others waiting.
constexpr double seconds_of_row = 60;
constexpr double memory_ratio_of_row = 20;

/// The study that the options request. Throws InputError.
Study study_of(const Compare& job) {
    const std::filesystem::path& input = job.input;
    const bool is_study = input.extension() == ".toml";
    Study study = is_study ? read_study(input, program_parameters()) : Study{};
    const GivenSettings given = given_settings(job.given);
    apply_with_input(is_study ? std::filesystem::path() : input, given, study);
    const bool is_named =
        is_study || std::ranges::any_of(given, [](const auto& s) { return s.first == "name"; });
    if (!is_named && study.sources.kind == SourcesKind::file) {
        apply({{"name", {study.sources.files.front().stem().string()}}}, study);
    }
    if (!is_study && !is_sampled(study.sources)) {
        if (!are_given(given, {"max_seconds"})) study.max_seconds = seconds_of_row;
        if (!are_given(given, {"max_memory_ratio"})) study.max_memory_ratio = memory_ratio_of_row;
    }
    if (job.as_published) {
        for (Run& run : study.runs) {
            run["law"] = {"mean-length"};
            run["schedule"] = {"passes"};
            run["reference"] = {"published-sphere"};
            run["intersection"] = {"in-turn"};
        }
    }
    return study;
}

/// Runs `prepared`, its rows into `folder`.
void run_into(ResultsFolder& folder, PreparedStudy prepared, Progress& progress,
              Interruption& interruption) {
    StudyObserver observer;
    observer.case_started = [&](const Case& c) {
        progress.case_started(c);
        start_library_of(c.structure);
    };
    observer.phase_started = [&](std::string_view phase) { progress.phase_started(phase); };
    observer.case_checked = [&](const Finished& finished, Row& row) {
        const auto whole = interruption.postpone();
        folder.sample_fields(finished, row);
    };
    observer.case_finished = [&](const Row& row) {
        const auto whole = interruption.postpone();
        folder.add(row);
        progress.case_finished(row);
        if (!row.is_as_requested()) {
            spdlog::warn("{}: {}{}", structure_label(row.setting), row.error, row.text("remark"));
        }
    };
    std::move(prepared).run(observer);
    const auto whole = interruption.postpone();
    folder.finish(true);
    progress.finish();
}

/// What an interrupted run of `study` left in `folder`: its provenance and its rows.
std::pair<Provenance, std::vector<Row>> go_on_from(const std::filesystem::path& folder,
                                                   const Study& study, const StudyRows& rows,
                                                   const Provenance& now) {
    const StoredResults earlier = read_results(folder, rows);
    try {
        return {earlier.provenance, rows_to_go_on_from(earlier, study, expand(study, rows), now)};
    } catch (const InputError& error) {
        refuse("--resume {}: {}", folder.string(), error.what());
    }
}

/// Runs the study on all structures that it names, with progress on standard error unless quiet,
/// its rows into a folder of results, and its tables to standard output. Returns the exit status;
/// throws InputError for what cannot be run.
int run(const Compare& job, const std::string& command_line) {
    Interruption interruption;
    const Study study = study_of(job);
    const auto threads = limit_threads(study.threads);
    const StudyRows rows = program_rows();
    const bool resumes = !job.resume.empty();
    Provenance provenance = current_provenance();
    provenance.command_line = command_line;
    const std::filesystem::path path = resumes ? job.resume : results_path(study, provenance);
    std::optional<FolderLock> lock;
    std::vector<Row> earlier;
    if (resumes) {
        lock.emplace(path, /*make=*/false);
        std::tie(provenance, earlier) = go_on_from(path, study, rows, provenance);
    }
    PreparedStudy prepared(study, rows, file_readers(), earlier.size());

    if (!resumes) lock.emplace(path, /*make=*/true);
    ResultsFolder folder = resumes
                               ? ResultsFolder(path, provenance, study, rows, std::move(earlier))
                               : ResultsFolder(path, provenance, study, rows);
    const std::size_t all = folder.rows().size() + prepared.cases().size();
    Progress progress(prepared.cases(), prepared.source_counts(),
                      job.quiet ? ProgressStyle::none : progress_style_of_stderr());
    {
        const Interruption::Watch watch(
            interruption, [&] { progress.show(); },
            [&] {
                progress.finish();
                folder.finish(false);
                print_error(fmt::format(
                    "controlspace: interrupted: {} of {} done, in {}; to continue, run the "
                    "same command with "
                    "--resume {} in place of --output\n",
                    folder.rows().size(), counted(all, "case"), folder.path().string(),
                    folder.path().string()));
            });
        run_into(folder, std::move(prepared), progress, interruption);
    }
    print(tables_text(folder.rows(), rows));
    print(fmt::format("\nResults: {}\n", folder.path().string()));
    return std::ranges::all_of(folder.rows(), &Row::is_as_requested) ? 0 : some_failed;
}

int compare(const Compare& job, const std::string& command_line) {
    if (!job.dry_run) return run(job, command_line);
    const PreparedStudy prepared(study_of(job), program_rows(), file_readers());
    print(forecast_text(prepared, forecast(prepared)));
    return 0;
}

}  // namespace

Action add_compare(Options& options) {
    const auto job = std::make_shared<Compare>();
    add_study_input(options, job->input);
    options.add_settings(Run{}, Study{}, job->given);
    options.set_note("Of settings with lists, all combinations are run.");
    options.add({"--as-published", " ",
                 "As for the paper's tables: --law mean-length --schedule passes --reference "
                 "published-sphere --intersection in-turn",
                 heading(Topic::paper)},
                job->as_published);
    for (const char* name : {"--law", "--schedule", "--reference", "--intersection"}) {
        options.exclude("--as-published", name);
    }
    options.add({"--dry-run", "",
                 "Only list the cases, with estimates of time and memory from small trials"},
                job->dry_run);
    options.add({"--resume", "FOLDER",
                 "Continue an interrupted run, whose results are in FOLDER: the study and the "
                 "settings must be the same, except --output"},
                job->resume);
    options.exclude("--resume", "--output");
    add_quiet(options, job->quiet);
    return [job](const std::string& command_line) { return compare(*job, command_line); };
}

}  // namespace controlspace
