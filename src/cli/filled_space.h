// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tbb/global_control.h>

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "cli/options.h"
#include "cli/progress.h"
#include "controlspace/space/control_space.h"
#include "controlspace/study/run.h"

namespace controlspace {

/// The case that a structure was made for.
struct Origin {
    Study study;
    Case c;
    Workload workload;
};

struct FilledSpace {
    std::unique_ptr<ControlSpace> space;
    std::string structure;  ///< id in the catalogue
    std::string remark;     ///< as remark_on
    /// Largest factor between its lengths and those of the exact field, at sampled places; none
    /// where it was adapted, or loaded.
    std::optional<double> within;
    bool missed_target = false;                    ///< with the reason in the remark
    std::optional<Origin> origin;                  ///< none of a control space that was loaded
    std::unique_ptr<tbb::global_control> threads;  ///< the study's limit, as long as this lives
};

/// Whether the file is a control space that was saved, or the index of one in pieces.
bool is_control_space(const std::filesystem::path& input);
/// Whether it is the index of an octree that ranks of MPI wrote in pieces (.pctrl).
bool is_in_pieces(const std::filesystem::path& input);
/// Loads either, to be read.
std::unique_ptr<ControlSpace> load_saved(const std::filesystem::path& input);

/// `before`, and the size of a file; empty for a pipe, which has none.
std::string size_of_file(const std::filesystem::path& file, std::string_view before);

/// Throws InputError, naming the first, where settings are given with a control space that was
/// saved.
void require_no_settings(const std::filesystem::path& space, const GivenSettings& given);

/// Loads and initializes the library that a structure depends on, if any, before its creation is
/// timed.
void start_library_of(const std::string& structure);

/// The one structure of the job's input (see study_of_input) and settings, made and graded; or
/// loaded from a .ctrl. Then calls `use`, in a step of the progress that is called `step`. Throws
/// InputError, also for a .ctrl with settings, and if the output is one of the files that are read.
FilledSpace filled_space(const Job& job, std::string_view step,
                         const std::function<void(const FilledSpace&, StepProgress&)>& use);
/// Writes to standard error how many of the points, which are `what`, are outside of the domain, if
/// any, and how far they reach.
void report_outside(std::span<const Point> points, std::string_view what, const Box& domain);

/// Writes the remark on the structure, and how far its lengths are from the exact field's, to
/// standard error. Returns the exit status: some_failed where the requested target was missed.
int report_remark(const FilledSpace& filled);

}  // namespace controlspace
