#include "app/compare.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <charconv>
#include <memory>
#include <optional>

#include "app/progress.h"
#include "app/signals.h"
#include "app/standard_output.h"
#include "baselines/catalogue.h"
#include "error.h"
#include "study/provenance.h"
#include "study/results.h"
#include "study/run.h"
#include "study/settings.h"
#include "study/study_file.h"
#include "study/tables.h"

namespace controlspace {
namespace {

/// Words of the command line as a setting of `type` takes them; a word that is no number stays a
/// text, for the setting to refuse.
SettingValues values_of(ValueType type, const std::vector<std::string>& words) {
    SettingValues values;
    for (const std::string& word : words) {
        double x = 0;
        const char* end = word.data() + word.size();
        const auto read = std::from_chars(word.data(), end, x);
        if (type != ValueType::text && read.ec == std::errc() && read.ptr == end) {
            values.emplace_back(x);
        } else {
            values.emplace_back(word);
        }
    }
    return values;
}

/// Sets `key` where it is one of `settings`.
template <class Target>
void apply(std::span<const Setting<Target>> settings, Target& target, const std::string& key,
           const std::vector<std::string>& words) {
    for (const Setting<Target>& setting : settings) {
        if (setting.key != key) continue;
        try {
            set_checked(setting, target, values_of(setting.type, words));
        } catch (const InputError& error) {
            std::string option = key;
            std::replace(option.begin(), option.end(), '_', '-');
            throw InputError(fmt::format("--{}: {}", option, error.what()));
        }
    }
}

/// Without a study file: the paper's sphere in both modes, unless the command line says what
/// concerns a mode or the sources.
Study starting_point(const CompareOptions& options) {
    if (!options.study_file.empty()) return read_study(options.study_file);
    bool one_mode = options.as_published;
    for (const auto& [key, words] : options.settings) {
        one_mode |= key == "sources" || key == "law" || key == "schedule" || key == "reference";
    }
    return one_mode ? Study{} : parse_study(quick_study_text(), "built-in study");
}

std::unique_ptr<tbb::global_control> limit_threads(int threads) {
    if (threads == 0) return nullptr;
    return std::make_unique<tbb::global_control>(tbb::global_control::max_allowed_parallelism,
                                                 static_cast<std::size_t>(threads));
}

/// Runs `prepared` and keeps what lies in `folder` up to date. Returns whether all cases succeeded.
bool run_and_record(PreparedStudy prepared, const ResultsFolder& folder,
                    const Provenance& provenance, Progress& progress, Interruption& interruption) {
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
    print(render_tables(study, rows, TableStyle::terminal));
    print(fmt::format("\nResults: {}\n", folder.path().string()));
    return std::all_of(rows.begin(), rows.end(), [](const Row& row) { return row.error.empty(); });
}

}  // namespace

Study study_of(const CompareOptions& options) {
    Study study = starting_point(options);
    for (const auto& [key, words] : options.settings) {
        apply(study_settings(), study, key, words);
        for (Run& run : study.runs) apply(run_settings(), run, key, words);
    }
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
    Interruption interruption;
    const Study study = study_of(options);
    const auto threads = limit_threads(study.threads);
    PreparedStudy prepared(study, structures());

    Provenance provenance = current_provenance();
    provenance.command_line = options.command_line;
    const ResultsFolder folder(results_path(study, provenance));
    Progress progress(prepared.cases(), prepared.source_counts(),
                      options.quiet ? ProgressStyle::none : progress_style_of_stderr());
    const Interruption::Watch watch(
        interruption, [&] { progress.show(); },
        [&] {
            progress.finish();
            print_error(fmt::format("controlspace: interrupted: {} of {} cases are in {}\n",
                                    progress.finished(), progress.count(), folder.path().string()));
        });
    return run_and_record(std::move(prepared), folder, provenance, progress, interruption);
}

}  // namespace controlspace
