#include "study/time_estimate.h"

#include <fmt/format.h>

#include <algorithm>

namespace controlspace {

std::string duration_text(double seconds) {
    const auto s = static_cast<long long>(seconds);
    return s < 3600 ? fmt::format("{}:{:02}", s / 60, s % 60)
                    : fmt::format("{}:{:02}:{:02}", s / 3600, s / 60 % 60, s % 60);
}

TimeEstimate::TimeEstimate(std::span<const Case> cases,
                           std::span<const std::size_t> source_counts) {
    for (std::size_t i = 0; i < cases.size(); ++i) {
        structures_.push_back(structure_label(cases[i]));
        // A field without sources is work too.
        const std::size_t sources = std::max<std::size_t>(1, source_counts[i]);
        work_.push_back(static_cast<double>(sources) / cases[i].tau);
    }
}

void TimeEstimate::case_finished(double seconds) {
    for (Pace* pace : {&overall_, &paces_[structures_[finished_]]}) {
        pace->seconds += seconds;
        pace->work += work_[finished_];
    }
    ++finished_;
}

std::optional<double> TimeEstimate::seconds_left() const {
    if (finished_ == 0) return std::nullopt;
    double seconds = 0;
    for (std::size_t i = finished_; i < work_.size(); ++i) {
        const auto own = paces_.find(structures_[i]);
        const Pace& pace = own != paces_.end() ? own->second : overall_;
        seconds += pace.seconds * work_[i] / pace.work;
    }
    return seconds;
}

}  // namespace controlspace
