#include "cli/compare.h"

#include <fmt/format.h>

#include <algorithm>

#include "cli/readers.h"
#include "cli/run_study.h"
#include "cli/signals.h"
#include "cli/standard_output.h"
#include "controlspace/baselines/catalogue.h"
#include "controlspace/error.h"
#include "study/forecast.h"
#include "study/study_file.h"
#include "study/tables.h"

namespace controlspace {
namespace {

/// Without a study file: the paper's sphere in both modes, unless the command line says what
/// concerns a mode or the sources.
Study starting_point(const CompareOptions& options) {
    const std::filesystem::path& file = options.study_file;
    if (file.has_extension() && file.extension() != ".toml") {
        throw InputError(fmt::format(
            "{0} is no study file (.toml): sources are given by --sources {0}", file.string()));
    }
    if (!file.empty()) return read_study(file);
    bool one_mode = options.as_published;
    for (const auto& [key, words] : options.settings) {
        one_mode |= key == "sources" || key == "field" || key == "law" || key == "schedule" ||
                    key == "reference";
    }
    return one_mode ? Study{} : parse_study(quick_study_text(), "built-in study");
}

}  // namespace

Study study_of(const CompareOptions& options) {
    Study study = starting_point(options);
    apply(options.settings, study);
    if (options.as_published) {
        for (Run& run : study.runs) {
            run.law = {GradationLaw::mean_length};
            run.schedule = {GradationSchedule::passes};
            run.reference = {ReferenceKind::published_sphere};
        }
    }
    return study;
}

bool compare(const CompareOptions& options) {
    if (options.dry_run) {
        const PreparedStudy prepared(study_of(options), structures(), file_readers());
        print(forecast_text(prepared, forecast(prepared)));
        return true;
    }
    Interruption interruption;
    const FinishedStudy finished = run_study(
        study_of(options), {options.command_line, options.quiet, options.resume}, interruption);
    print(render_tables(finished.rows, TableStyle::terminal));
    print(fmt::format("\nResults: {}\n", finished.folder.string()));
    return std::all_of(finished.rows.begin(), finished.rows.end(),
                       [](const Row& row) { return row.error.empty(); });
}

}  // namespace controlspace
