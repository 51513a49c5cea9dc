#include "cli/progress.h"

#include <fmt/format.h>
#include <unistd.h>

#include "cli/live_line.h"
#include "cli/standard_output.h"

namespace controlspace {
namespace {

double seconds_between(std::chrono::steady_clock::time_point a,
                       std::chrono::steady_clock::time_point b) {
    return std::chrono::duration<double>(b - a).count();
}

}  // namespace

ProgressStyle progress_style_of_stderr() {
    return isatty(STDERR_FILENO) != 0 ? ProgressStyle::live : ProgressStyle::lines;
}

Progress::Progress(std::span<const Case> cases, std::span<const std::size_t> source_counts,
                   ProgressStyle style)
    : count_(cases.size()), style_(style), estimate_(cases, source_counts) {}

void Progress::case_started(const Case& c) {
    const std::lock_guard lock(mutex_);
    case_ = structure_label(c);
    phase_.clear();
    case_start_ = Clock::now();
}

void Progress::phase_started(std::string_view phase) {
    const std::lock_guard lock(mutex_);
    phase_ = phase;
}

void Progress::case_finished(const Row& row) {
    const std::lock_guard lock(mutex_);
    const double seconds = seconds_between(case_start_, Clock::now());
    estimate_.case_finished(seconds);
    ++finished_;
    if (style_ == ProgressStyle::lines) {
        print_error(fmt::format("case {}/{}: {}, {}: {}{:.2f} s\n", finished_, count_, case_,
                                setting_label(row.setting), row.measures ? "" : "failed, ",
                                seconds));
    }
    clear_line();
}

void Progress::show() {
    const std::lock_guard lock(mutex_);
    if (style_ != ProgressStyle::live || over_ || finished_ == count_) return;
    const double elapsed = seconds_between(start_, Clock::now());
    std::string line = fmt::format("case {}/{}  {}  {}  {} elapsed", finished_ + 1, count_, case_,
                                   phase_, duration_text(elapsed));
    if (const auto left = estimate_.seconds_left()) {
        line += fmt::format(", {:.2g} cases/s, about {} left",
                            static_cast<double>(finished_) / elapsed, duration_text(*left));
    }
    show_live_line(line);
}

void Progress::finish() {
    const std::lock_guard lock(mutex_);
    clear_line();
    over_ = true;
}

std::size_t Progress::finished() const {
    const std::lock_guard lock(mutex_);
    return finished_;
}

void Progress::clear_line() {
    if (style_ != ProgressStyle::live || over_) return;
    clear_live_line();
}

}  // namespace controlspace
