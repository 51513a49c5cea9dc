#include "cli/run_study.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <string_view>
#include <tuple>
#include <utility>

#include "cli/formats.h"
#include "cli/progress.h"
#include "cli/standard_output.h"
#include "cli/threads.h"
#include "controlspace/baselines/catalogue.h"
#include "controlspace/error.h"
#include "modules/load.h"
#include "study/results.h"
#include "study/resume.h"
#include "study/run.h"

namespace controlspace {
namespace {

/// Runs `prepared`, whose rows come after `rows`, and keeps what lies in `folder` up to date.
std::vector<Row> run_and_record(PreparedStudy prepared, std::vector<Row> rows,
                                const ResultsFolder& folder, const Provenance& provenance,
                                Progress& progress, Interruption& interruption) {
    const Study study = prepared.study();
    const auto record = [&](bool complete) {
        const auto whole = interruption.postpone();
        folder.write(provenance, study, rows, complete);
    };
    record(false);
    std::move(prepared).run({
        .case_started =
            [&](const Case& c) {
                progress.case_started(c);
                load_module_of(c.structure);  // before its creation is timed
            },
        .phase_started = [&](std::string_view phase) { progress.phase_started(phase); },
        .case_finished =
            [&](const Row& row) {
                rows.push_back(row);
                progress.case_finished(row);
                record(false);
                if (!row.error.empty()) {
                    spdlog::warn("{}: {}", structure_label(row.setting), row.error);
                }
            },
    });
    record(true);
    progress.finish();
    return rows;
}

/// What an interrupted run of `study` left in `folder`: its provenance and its rows.
std::pair<Provenance, std::vector<Row>> go_on_from(const std::filesystem::path& folder,
                                                   const Study& study, const Provenance& now) {
    const StoredResults earlier = read_results(folder);
    try {
        return {earlier.provenance,
                rows_to_go_on_from(earlier, study, expand(study, structures()), now)};
    } catch (const InputError& error) {
        throw InputError(fmt::format("--resume {}: {}", folder.string(), error.what()));
    }
}

}  // namespace

FinishedStudy run_study(const Study& study, const RunOptions& options, Interruption& interruption) {
    const auto threads = limit_threads(study.threads);
    const bool resumes = !options.resume.empty();
    Provenance provenance = current_provenance();
    provenance.command_line = options.command_line;
    std::vector<Row> rows;
    if (resumes) std::tie(provenance, rows) = go_on_from(options.resume, study, provenance);
    PreparedStudy prepared(study, structures(), file_readers(), rows.size());

    const ResultsFolder folder = resumes ? ResultsFolder::existing(options.resume)
                                         : ResultsFolder(results_path(study, provenance));
    Progress progress(prepared.cases(), prepared.source_counts(),
                      options.quiet ? ProgressStyle::none : progress_style_of_stderr());
    const std::size_t finished_before = rows.size();
    const Interruption::Watch watch(
        interruption, [&] { progress.show(); },
        [&] {
            progress.finish();
            print_error(fmt::format(
                "controlspace: interrupted: {} of {} cases are in {}; to go on, run the same "
                "command with --resume {} in place of --output\n",
                finished_before + progress.finished(), finished_before + progress.count(),
                folder.path().string(), folder.path().string()));
        });
    rows = run_and_record(std::move(prepared), std::move(rows), folder, provenance, progress,
                          interruption);
    return {study, std::move(rows), provenance, folder.path()};
}

}  // namespace controlspace
