#include "study/resume.h"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>

#include "controlspace/error.h"
#include "study/settings.h"

namespace controlspace {
namespace {

/// Whether `row` is the outcome of `c`, whose voxels may have been chosen by the study itself.
bool is_outcome_of(const Row& row, Case c) {
    if (c.equal_delta || c.equal_memory) {
        c.voxel = row.setting.voxel;
        c.voxel_factor = row.setting.voxel_factor;
        c.prune_delta = row.setting.prune_delta;
    }
    return row.setting == c;
}

void require_same_program(const Provenance& earlier, const Provenance& now) {
    const auto same = [](std::string_view what, std::string_view a, std::string_view b) {
        if (a == b) return;
        throw InputError(
            fmt::format("{} was \"{}\" and is \"{}\" now: run the study anew, since "
                        "times of the two cannot be compared",
                        what, a, b));
    };
    same("the program", version_text(earlier), version_text(now));
    same("the compiler", earlier.compiler + ", " + earlier.flags, now.compiler + ", " + now.flags);
    same("the processor", earlier.cpu, now.cpu);
}

void require_same_settings(const Study& earlier, const Study& now) {
    // What does not change a row.
    constexpr std::string_view free[] = {"name", "output", "threads"};
    for (const Setting<Study>& setting : study_settings()) {
        if (std::ranges::count(free, setting.key) > 0) continue;
        if (setting.get(earlier) != setting.get(now)) {
            throw InputError(
                fmt::format("{} differs from what it was: give the same settings, or "
                            "run the study anew",
                            setting.key));
        }
    }
}

}  // namespace

std::vector<Row> rows_to_go_on_from(const StoredResults& earlier, const Study& study,
                                    std::span<const Case> cases, const Provenance& now) {
    if (earlier.complete) throw InputError("these results are complete: nothing is left to run");
    require_same_program(earlier.provenance, now);
    require_same_settings(earlier.study, study);
    for (std::size_t i = 0; i < earlier.rows.size(); ++i) {
        if (i < cases.size() && is_outcome_of(earlier.rows[i], cases[i])) continue;
        throw InputError(fmt::format(
            "row {} is {}, which is no case {} of this study: give the study that was interrupted",
            i + 1, structure_label(earlier.rows[i].setting), i + 1));
    }
    return earlier.rows;
}

}  // namespace controlspace
