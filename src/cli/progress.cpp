// SPDX-License-Identifier: Apache-2.0
#include "cli/progress.h"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <utility>

#include "cli/standard_output.h"
#include "files/output_file.h"

namespace controlspace {
namespace {

/// Writes `text`, as much of it as fits, over the current line of the terminal.
void show_live_line(const std::string& text) {
    winsize size{};
    const bool known = ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0;
    print_error(fmt::format("\r\033[K{}", text.substr(0, (known ? size.ws_col : 80) - 1)));
}

void clear_live_line() { print_error("\r\033[K"); }

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
}

void Progress::phase_started(std::string_view phase) {
    const std::lock_guard lock(mutex_);
    phase_ = phase;
}

void Progress::case_finished(const Row& row) {
    const std::lock_guard lock(mutex_);
    estimate_.case_finished(row.seconds);
    ++finished_;
    if (style_ == ProgressStyle::lines) {
        print_error(fmt::format("case {}/{}: {}, {}: {}{:.2f} s\n", finished_, count_,
                                structure_label(row.setting), setting_label(row.setting),
                                row.is_measured() ? "" : "failed, ", row.seconds));
    }
    clear_line();
}

void Progress::show() {
    const std::lock_guard lock(mutex_);
    if (style_ != ProgressStyle::live || over_ || finished_ == count_) return;
    const double elapsed = all_.seconds();
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

void Progress::clear_line() {
    if (style_ == ProgressStyle::live && !over_) clear_live_line();
}

StepProgress::StepProgress(bool quiet, std::filesystem::path output)
    : live_(!quiet && progress_style_of_stderr() == ProgressStyle::live),
      outputs_{std::move(output)} {
    watch_.emplace(
        interruption_, [this] { show(); },
        [this] {
            clear();
            const std::lock_guard lock(mutex_);
            for (const std::filesystem::path& file : outputs_) {
                std::error_code ignored;
                std::filesystem::remove(OutputFile::partial(file), ignored);
            }
            print_error("controlspace: interrupted: nothing was written\n");
        });
}

StepProgress::~StepProgress() {
    watch_.reset();
    clear();
}

void StepProgress::writes(std::filesystem::path output) {
    const std::lock_guard lock(mutex_);
    outputs_.push_back(std::move(output));
}

void StepProgress::started(std::string_view step) {
    const std::lock_guard lock(mutex_);
    step_ = step;
    step_time_ = {};
    part_.reset();
}

void StepProgress::advanced(std::size_t done, std::size_t all, std::string_view unit) {
    const std::lock_guard lock(mutex_);
    part_ = {done, all, std::string(unit)};
}

StudyObserver StepProgress::observer() {
    StudyObserver observer;
    observer.phase_started = [this](std::string_view phase) { started(phase); };
    return observer;
}

void StepProgress::show() {
    constexpr double short_run = 2;
    const std::lock_guard lock(mutex_);
    const double elapsed = all_.seconds();
    if (!live_ || elapsed < short_run) return;
    shown_ = true;
    const std::string part =
        part_ ? part_text(part_->done, part_->all, part_->unit, step_time_.seconds()) + ", " : "";
    show_live_line(fmt::format("{}  {}{} elapsed", step_, part, duration_text(elapsed)));
}

void StepProgress::clear() {
    const std::lock_guard lock(mutex_);
    if (std::exchange(shown_, false)) clear_live_line();
}

}  // namespace controlspace
