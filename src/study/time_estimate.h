// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "controlspace/study/case.h"

namespace controlspace {

/// "0:07", "12:30", "1:02:03".
std::string duration_text(double seconds);

/// How far a step has come after `seconds`: "12.5 of 50.0 million voxels, 2.50 million/s, about
/// 0:15 left"; below ten millions "12 of 50 voxels, 3/s, about 0:12 left".
std::string part_text(std::size_t done, std::size_t all, std::string_view unit, double seconds);

/// Estimates the remaining time of a study from its finished cases: in proportion to sources / tau,
/// at the pace of the same structure where one has finished, else at that of all.
class TimeEstimate {
public:
    /// `source_counts[i]` belongs to `cases[i]`.
    TimeEstimate(std::span<const Case> cases, std::span<const std::size_t> source_counts);

    /// The next case, in order, took `seconds`.
    void case_finished(double seconds);

    /// None until a case has finished.
    std::optional<double> seconds_left() const;

private:
    struct Pace {
        double seconds = 0;
        double work = 0;
    };
    std::vector<std::string> structures_;  ///< of each case
    std::vector<double> work_;             ///< of each case
    std::size_t finished_ = 0;
    Pace overall_;
    std::map<std::string, Pace> paces_;  ///< by structure
};

}  // namespace controlspace
