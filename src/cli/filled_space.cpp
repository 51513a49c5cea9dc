// SPDX-License-Identifier: Apache-2.0
#include "cli/filled_space.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <utility>

#include "cli/command.h"
#include "cli/formats.h"
#include "cli/input_study.h"
#include "cli/paper_reference.h"
#include "cli/standard_output.h"
#include "cli/threads.h"
#include "controlspace/baselines/catalogue.h"
#include "controlspace/measure/accuracy.h"
#include "controlspace/space/control_space_file.h"
#include "controlspace/trees/octree_pieces.h"
#include "geometry/extent_of.h"
#include "modules/load.h"
#include "refuse.h"

namespace controlspace {

bool is_control_space(const std::filesystem::path& input) {
    return holds_control_space(input) || is_in_pieces(input);
}
bool is_in_pieces(const std::filesystem::path& input) { return input.extension() == ".pctrl"; }

std::unique_ptr<ControlSpace> load_saved(const std::filesystem::path& input) {
    return is_in_pieces(input) ? load_octree_pieces(input, structures())
                               : load_control_space(input, structures());
}

std::string size_of_file(const std::filesystem::path& file, std::string_view before) {
    std::error_code unknown;
    const auto bytes = static_cast<double>(std::filesystem::file_size(file, unknown));
    return unknown ? "" : fmt::format("{}{:.3g} MB in the file", before, bytes / 1e6);
}

void require_no_settings(const std::filesystem::path& space, const GivenSettings& given) {
    if (given.empty()) return;
    refuse("{}: {} was made with its own: leave it out", option_name(given.front().first),
           space.string());
}

void start_library_of(const std::string& structure) {
    load_module_of(structure);
    const CatalogueEntry& entry = *find_entry(structures(), structure);
    if (entry.family == "peers") {
        entry.make({.domain = {Point::Zero(), Point::Ones()}, .finest_length = 1});
    }
}

namespace {

constexpr int probes = 20;  // along each axis

double largest_factor(const Origin& made, const ControlSpace& space) {
    const auto exact = make_reference(made.study, made.c, made.workload);
    return accuracy(space, make_probes(*exact, cell_centres(made.workload.domain, probes)))
        .within();
}

FilledSpace made_or_loaded(const std::filesystem::path& input, const std::filesystem::path& output,
                           const GivenSettings& given, const StudyObserver& observer) {
    require_output(output, {input});
    FilledSpace filled;
    if (observer.phase_started) observer.phase_started("reading");
    if (is_control_space(input)) {
        require_no_settings(input, given);
        if (is_in_pieces(input)) {
            filled.space = load_saved(input);
            filled.structure = "an octree in pieces";
            return filled;
        }
        SavedControlSpace saved = open_control_space(input, structures());
        filled.space = std::move(saved.space);
        filled.structure = std::move(saved.recipe.structure);
        filled.remark = filled.space->footprint().remark;
        return filled;
    }
    Study study = study_of_input(input, given);
    require_output(output, input_files_of(study.sources));
    filled.threads = limit_threads(study.threads);
    Case c = only_case(study);
    Workload workload = make_workload(study, c.sources, file_readers());
    DefaultTarget(input, given).set(c, workload);
    const bool is_exact_field = c.structure == "direct";
    Filled made = make_and_fill(study, c, program_rows(), workload, observer);
    filled.space = std::move(made.space);
    filled.structure = c.structure;
    filled.remark = remark_on(made.creation, filled.space->footprint());
    filled.missed_target = !made.creation.shortfall.empty();
    filled.origin = Origin{std::move(study), c, std::move(workload)};
    if (!c.target_delta && !has_field(c.sources) && !is_exact_field) {
        if (observer.phase_started) observer.phase_started("comparing");
        filled.within = largest_factor(*filled.origin, *filled.space);
    }
    return filled;
}

}  // namespace

FilledSpace filled_space(const Job& job, std::string_view step,
                         const std::function<void(const FilledSpace&, StepProgress&)>& use) {
    StepProgress progress(job.quiet, job.output);
    FilledSpace filled =
        made_or_loaded(job.input, job.output, given_settings(job.given), progress.observer());
    progress.started(step);
    use(filled, progress);
    return filled;
}

void report_outside(std::span<const Point> points, std::string_view what, const Box& domain) {
    const auto outside =
        std::ranges::count_if(points, [&](const Point& p) { return !domain.contains(p); });
    if (outside == 0) return;
    print_error(
        fmt::format("{} of {} {} are outside the domain {}: they have the metric of its nearest "
                    "point; all are in {} (--domain)\n",
                    outside, points.size(), what, to_string(domain), to_string(extent_of(points))));
}

int report_remark(const FilledSpace& filled) {
    if (filled.missed_target) {
        spdlog::warn("{}: {}", filled.structure, filled.remark);
        return some_failed;
    }
    if (!filled.remark.empty()) {
        print_error(fmt::format("{}: {}\n", filled.structure, filled.remark));
    }
    if (filled.within) {
        constexpr double far = 1.25;  // edges within it conform
        std::string remedy;
        if (*filled.within > far) {
            remedy = fmt::format(": --within {} adapts a tree (K_oV) to that field",
                                 default_within_of(filled.origin->workload));
        }
        print_error(fmt::format("{}: lengths within {:.3g}x of the exact field's at {} places{}\n",
                                filled.structure, *filled.within, probes * probes * probes,
                                remedy));
    }
    return 0;
}

}  // namespace controlspace
