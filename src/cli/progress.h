#pragma once

#include <chrono>
#include <mutex>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "study/case.h"
#include "study/row.h"
#include "study/time_estimate.h"

namespace controlspace {

enum class ProgressStyle {
    none,
    lines,  ///< one line for each finished case
    live,   ///< one line on the terminal that is written again and again
};

/// live on a terminal, lines elsewhere.
ProgressStyle progress_style_of_stderr();

/// Progress of a study on standard error: which case, what runs, elapsed time, rate and time left.
/// May be shown by one thread while another reports.
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

    std::size_t finished() const;
    std::size_t count() const { return count_; }

private:
    using Clock = std::chrono::steady_clock;
    void clear_line();

    const std::size_t count_;
    const ProgressStyle style_;
    const Clock::time_point start_ = Clock::now();
    mutable std::mutex mutex_;
    Clock::time_point case_start_ = start_;
    TimeEstimate estimate_;
    std::string case_;
    std::string phase_;
    std::size_t finished_ = 0;
    bool over_ = false;
};

}  // namespace controlspace
