// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "cli/signals.h"
#include "controlspace/study/run.h"
#include "measure/stopwatch.h"
#include "study/time_estimate.h"

namespace controlspace {

enum class ProgressStyle {
    none,
    lines,  ///< one line for each finished case
    live,   ///< one line on the terminal, rewritten several times a second
};

/// live on a terminal, lines elsewhere.
ProgressStyle progress_style_of_stderr();

/// Progress of a study on standard error: case, phase, elapsed time, rate and time left. May be
/// shown by one thread while another reports.
class Progress {
public:
    Progress(std::span<const Case> cases, std::span<const std::size_t> source_counts,
             ProgressStyle style);

    void case_started(const Case& c);
    void phase_started(std::string_view phase);
    void case_finished(const Row& row);

    /// Writes the live line as of now.
    void show();
    /// Clears the live line for good.
    void finish();

private:
    void clear_line();

    const std::size_t count_;
    const ProgressStyle style_;
    const Stopwatch all_;
    mutable std::mutex mutex_;
    TimeEstimate estimate_;
    std::string case_;
    std::string phase_;
    std::size_t finished_ = 0;
    bool over_ = false;
};

/// Progress of a command that writes one file, step by step, on standard error: unless `quiet`, on
/// a terminal, after the first two seconds. Shows the current step and, where it is known, how much
/// of it is done, the rate and the time left. Ctrl-C ends the program and removes the unfinished
/// file. To be constructed before any other thread starts; any thread may report.
class StepProgress {
public:
    StepProgress(bool quiet, std::filesystem::path output);
    ~StepProgress();
    StepProgress(const StepProgress&) = delete;
    StepProgress& operator=(const StepProgress&) = delete;

    /// One more file that is written.
    void writes(std::filesystem::path output);
    void started(std::string_view step);
    /// `done` of `all` of the step's units are done.
    void advanced(std::size_t done, std::size_t all, std::string_view unit);
    /// Reports the phases of building a structure as steps.
    StudyObserver observer();

private:
    struct Part {
        std::size_t done, all;
        std::string unit;
    };

    void show();
    void clear();

    const bool live_;
    const Stopwatch all_;
    std::mutex mutex_;
    std::vector<std::filesystem::path> outputs_;
    std::string step_;
    Stopwatch step_time_;
    std::optional<Part> part_;
    bool shown_ = false;
    Interruption interruption_;
    std::optional<Interruption::Watch> watch_;
};

}  // namespace controlspace
