#include "cli/run_study.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <string_view>
#include <tuple>
#include <utility>

#include "cli/formats.h"
#include "cli/paper_reference.h"
#include "cli/progress.h"
#include "cli/standard_output.h"
#include "cli/threads.h"
#include "controlspace/baselines/catalogue.h"
#include "controlspace/error.h"
#include "controlspace/study/run.h"
#include "modules/load.h"
#include "study/text_table.h"

namespace controlspace {
namespace {

/// Runs `prepared`, its rows into `folder`.
void run_into(ResultsFolder& folder, PreparedStudy prepared, Progress& progress,
              Interruption& interruption) {
    StudyObserver observer;
    observer.case_started = [&](const Case& c) {
        progress.case_started(c);
        load_module_of(c.structure);  // before its creation is timed
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
        throw InputError(fmt::format("--resume {}: {}", folder.string(), error.what()));
    }
}

}  // namespace

FinishedStudy run_study(const Study& study, const RunOptions& options, Interruption& interruption) {
    const auto threads = limit_threads(study.threads);
    const StudyRows rows = program_rows();
    const bool resumes = !options.resume.empty();
    Provenance provenance = current_provenance();
    provenance.command_line = options.command_line;
    std::vector<Row> earlier;
    if (resumes)
        std::tie(provenance, earlier) = go_on_from(options.resume, study, rows, provenance);
    PreparedStudy prepared(study, rows, file_readers(), earlier.size());

    ResultsFolder folder =
        resumes ? ResultsFolder(options.resume, provenance, study, rows, std::move(earlier))
                : ResultsFolder(results_path(study, provenance), provenance, study, rows);
    const std::size_t all = folder.rows().size() + prepared.cases().size();
    Progress progress(prepared.cases(), prepared.source_counts(),
                      options.quiet ? ProgressStyle::none : progress_style_of_stderr());
    const Interruption::Watch watch(
        interruption, [&] { progress.show(); },
        [&] {
            progress.finish();
            folder.finish(false);
            print_error(
                fmt::format("controlspace: interrupted: {} of {} done, in {}; to continue, run the "
                            "same command with "
                            "--resume {} in place of --output\n",
                            folder.rows().size(), counted(all, "case"), folder.path().string(),
                            folder.path().string()));
        });
    run_into(folder, std::move(prepared), progress, interruption);
    return {{folder.rows().begin(), folder.rows().end()}, folder.path()};
}

}  // namespace controlspace
