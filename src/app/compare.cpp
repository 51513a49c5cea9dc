#include "app/compare.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>

#include "app/run_study.h"
#include "app/signals.h"
#include "app/standard_output.h"
#include "error.h"
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
    const FinishedStudy finished =
        run_study(study_of(options), options.command_line, options.quiet, interruption);
    print(render_tables(finished.study, finished.rows, TableStyle::terminal));
    print(fmt::format("\nResults: {}\n", finished.folder.string()));
    return std::all_of(finished.rows.begin(), finished.rows.end(),
                       [](const Row& row) { return row.error.empty(); });
}

}  // namespace controlspace
