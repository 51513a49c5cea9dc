#include "app/run_study.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <string_view>
#include <utility>

#include "app/progress.h"
#include "app/readers.h"
#include "app/standard_output.h"
#include "app/threads.h"
#include "baselines/catalogue.h"
#include "study/results.h"
#include "study/run.h"

namespace controlspace {
namespace {

/// Runs `prepared` and keeps what lies in `folder` up to date.
std::vector<Row> run_and_record(PreparedStudy prepared, const ResultsFolder& folder,
                                const Provenance& provenance, Progress& progress,
                                Interruption& interruption) {
    const Study study = prepared.study();
    std::vector<Row> rows;
    const auto record = [&](bool complete) {
        const auto whole = interruption.postpone();
        folder.write(provenance, study, rows, complete);
    };
    record(false);
    std::move(prepared).run({
        .case_started = [&](const Case& c) { progress.case_started(c); },
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

}  // namespace

FinishedStudy run_study(const Study& study, const std::string& command_line, bool quiet,
                        Interruption& interruption) {
    const auto threads = limit_threads(study.threads);
    PreparedStudy prepared(study, structures(), file_readers());

    Provenance provenance = current_provenance();
    provenance.command_line = command_line;
    const ResultsFolder folder(results_path(study, provenance));
    Progress progress(prepared.cases(), prepared.source_counts(),
                      quiet ? ProgressStyle::none : progress_style_of_stderr());
    const Interruption::Watch watch(
        interruption, [&] { progress.show(); },
        [&] {
            progress.finish();
            print_error(fmt::format("controlspace: interrupted: {} of {} cases are in {}\n",
                                    progress.finished(), progress.count(), folder.path().string()));
        });
    std::vector<Row> rows =
        run_and_record(std::move(prepared), folder, provenance, progress, interruption);
    return {study, std::move(rows), provenance, folder.path()};
}

}  // namespace controlspace
