// SPDX-License-Identifier: Apache-2.0
#include "study/time_estimate.h"

#include <fmt/format.h>

#include <algorithm>

#include "controlspace/study/parameter.h"

namespace controlspace {

std::string duration_text(double seconds) {
    const auto s = static_cast<long long>(seconds);
    return s < 3600 ? fmt::format("{}:{:02}", s / 60, s % 60)
                    : fmt::format("{}:{:02}:{:02}", s / 3600, s / 60 % 60, s % 60);
}

std::string part_text(std::size_t done, std::size_t all, std::string_view unit, double seconds) {
    constexpr double million = 1e6;
    const auto now = static_cast<double>(done), end = static_cast<double>(all);
    const double rate = seconds > 0 ? now / seconds : 0;
    std::string text = end < 10 * million
                           ? fmt::format("{} of {} {}, {:.3g}/s", done, all, unit, rate)
                           : fmt::format("{:.1f} of {:.1f} million {}, {:.2f} million/s",
                                         now / million, end / million, unit, rate / million);
    if (rate > 0) text += ", about " + duration_text((end - now) / rate) + " left";
    return text;
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
