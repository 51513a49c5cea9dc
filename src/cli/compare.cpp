// The command `compare`: runs a study.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <memory>

#include "cli/command.h"
#include "cli/formats.h"
#include "cli/input_study.h"
#include "cli/options.h"
#include "cli/paper_reference.h"
#include "cli/run_study.h"
#include "cli/signals.h"
#include "cli/standard_output.h"
#include "controlspace/baselines/catalogue.h"
#include "controlspace/error.h"
#include "study/forecast.h"

namespace controlspace {
namespace {

struct Compare {
    std::filesystem::path input;  ///< study file or sources; empty: one run, on the sphere
    WordsByKey given;             ///< they override the study file in all of its runs
    bool as_published = false;
    std::filesystem::path resume;  ///< folder of an interrupted run to continue, or empty
    bool dry_run = false;          ///< list the cases instead of running them
    bool quiet = false;
};

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
        apply({{"name", {study.sources.file.stem().string()}}}, study);
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

int compare(const Compare& job, const std::string& command_line) {
    if (job.dry_run) {
        const PreparedStudy prepared(study_of(job), program_rows(), file_readers());
        print(forecast_text(prepared, forecast(prepared)));
        return 0;
    }
    Interruption interruption;
    const FinishedStudy finished =
        run_study(study_of(job), {command_line, job.quiet, job.resume}, interruption);
    print(tables_text(finished.rows, program_rows(), /*markdown=*/false));
    print(fmt::format("\nResults: {}\n", finished.folder.string()));
    return std::ranges::all_of(finished.rows, &Row::is_as_requested) ? 0 : some_failed;
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
