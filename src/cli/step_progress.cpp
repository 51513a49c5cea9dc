#include "cli/step_progress.h"

#include <fmt/format.h>

#include <utility>

#include "cli/live_line.h"
#include "cli/progress.h"
#include "cli/standard_output.h"
#include "io/text/output_file.h"
#include "study/time_estimate.h"

namespace controlspace {
namespace {

double seconds_since(std::chrono::steady_clock::time_point start) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

}  // namespace

StepProgress::StepProgress(bool quiet, std::filesystem::path output)
    : live_(!quiet && progress_style_of_stderr() == ProgressStyle::live),
      output_(std::move(output)) {
    watch_.emplace(
        interruption_, [this] { show(); },
        [this] {
            clear();
            std::error_code ignored;
            std::filesystem::remove(OutputFile::partial(output_), ignored);
            print_error("controlspace: interrupted: nothing was written\n");
        });
}

StepProgress::~StepProgress() {
    watch_.reset();
    clear();
}

void StepProgress::started(std::string_view step) {
    const std::lock_guard lock(mutex_);
    step_ = step;
    step_start_ = Clock::now();
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
    if (!live_ || seconds_since(start_) < short_run) return;
    shown_ = true;
    const std::string part =
        part_ ? part_text(part_->done, part_->all, part_->unit, seconds_since(step_start_)) : "";
    show_live_line(fmt::format("{}  {}{} elapsed", step_, part.empty() ? "" : part + ", ",
                               duration_text(seconds_since(start_))));
}

void StepProgress::clear() {
    const std::lock_guard lock(mutex_);
    if (std::exchange(shown_, false)) clear_live_line();
}

}  // namespace controlspace
