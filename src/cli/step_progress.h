#pragma once

#include <chrono>
#include <cstddef>
#include <filesystem>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>

#include "cli/signals.h"
#include "study/run.h"

namespace controlspace {

/// Progress of a command that makes one file, step after step, on standard error where that is a
/// terminal and unless it is `quiet`: from two seconds on, what runs, and where it is known how
/// much of it is done, how fast that goes and how long the rest may take. Ctrl-C ends the program,
/// of which nothing is left. Made before any other thread; steps may be told of by any.
class StepProgress {
public:
    StepProgress(bool quiet, std::filesystem::path output);
    ~StepProgress();
    StepProgress(const StepProgress&) = delete;
    StepProgress& operator=(const StepProgress&) = delete;

    void started(std::string_view step);
    /// So much of the step is done, of all that there is of `unit`.
    void advanced(std::size_t done, std::size_t all, std::string_view unit);
    /// Tells of the steps of making a structure.
    StudyObserver observer();

private:
    using Clock = std::chrono::steady_clock;
    struct Part {
        std::size_t done, all;
        std::string unit;
    };

    void show();
    void clear();

    const bool live_;
    const std::filesystem::path output_;
    const Clock::time_point start_ = Clock::now();
    std::mutex mutex_;
    std::string step_;
    Clock::time_point step_start_ = start_;
    std::optional<Part> part_;
    bool shown_ = false;
    Interruption interruption_;
    std::optional<Interruption::Watch> watch_;
};

}  // namespace controlspace
