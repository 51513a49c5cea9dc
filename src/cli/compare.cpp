// The command `compare`: runs a study.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <memory>

#include "cli/command.h"
#include "cli/formats.h"
#include "cli/options.h"
#include "cli/run_study.h"
#include "cli/signals.h"
#include "cli/standard_output.h"
#include "controlspace/baselines/catalogue.h"
#include "controlspace/error.h"
#include "study/embedded.h"
#include "study/forecast.h"

namespace controlspace {
namespace {

struct Compare {
    std::filesystem::path study_file;  ///< empty: the built-in study
    WordsByKey given;                  ///< they override the study file in all of its runs
    bool as_published = false;
    std::filesystem::path resume;  ///< folder of an interrupted run to go on with, or empty
    bool dry_run = false;          ///< say what would be run
    bool quiet = false;
};

/// Without a study file: the paper's sphere in both modes, unless the command line says what
/// concerns a mode or the sources.
Study starting_point(const Compare& job) {
    const std::filesystem::path& file = job.study_file;
    if (file.has_extension() && file.extension() != ".toml") {
        throw InputError(fmt::format(
            "{0} is no study file (.toml): sources are given by --sources {0}", file.string()));
    }
    if (!file.empty()) return read_study(file);
    bool one_mode = job.as_published;
    for (const auto& [key, words] : given_settings(job.given)) {
        one_mode |= key == "sources" || key == "field" || key == "law" || key == "schedule" ||
                    key == "reference";
    }
    return one_mode ? Study{} : parse_study(quick_study_text(), "built-in study");
}

/// The study that the options ask for. Throws InputError.
Study study_of(const Compare& job) {
    Study study = starting_point(job);
    const GivenSettings given = given_settings(job.given);
    apply(given, study);
    if (job.as_published) {
        for (Run& run : study.runs) {
            run["law"] = {"mean-length"};
            run["schedule"] = {"passes"};
            run["reference"] = {"published-sphere"};
        }
    }
    return study;
}

int compare(const Compare& job, const std::string& command_line) {
    if (job.dry_run) {
        const PreparedStudy prepared(study_of(job), {structures()}, file_readers());
        print(forecast_text(prepared, forecast(prepared)));
        return 0;
    }
    Interruption interruption;
    const FinishedStudy finished =
        run_study(study_of(job), {command_line, job.quiet, job.resume}, interruption);
    print(tables_text(finished.rows, {structures()}, /*markdown=*/false));
    print(fmt::format("\nResults: {}\n", finished.folder.string()));
    const bool all_measured = std::all_of(finished.rows.begin(), finished.rows.end(),
                                          [](const Row& row) { return row.error.empty(); });
    return all_measured ? 0 : some_failed;
}

}  // namespace

Action add_compare(Options& options) {
    const auto job = std::make_shared<Compare>();
    options.add(
        {"STUDY", "FILE.toml",
         "Study file (.toml); left out: the paper's sphere at rho = tau = 1, in both modes, "
         "or one run if sources, field, law, schedule or reference are given"},
        job->study_file);
    const std::string group = "Settings of cases (lists with commas; all combinations are run)";
    options.add_case_parameters(Run{}, group, job->given);
    options.add({"--as-published", " ",
                 "As for the paper's tables: --law mean-length --schedule passes --reference "
                 "published-sphere",
                 group},
                job->as_published);
    for (const char* name : {"--law", "--schedule", "--reference"}) {
        options.exclude("--as-published", name);
    }
    options.add_parameters(study_parameters(), Study{}, "Settings of the study", job->given);
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
