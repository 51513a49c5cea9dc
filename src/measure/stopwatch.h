// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <ctime>

namespace controlspace {

/// Time since it was made.
class Stopwatch {
public:
    /// By the clock, which goes on while the system runs other programs.
    double seconds() const { return std::chrono::duration<double>(Clock::now() - start_).count(); }
    /// Of processors, of all threads of this program together.
    double processor_seconds() const {
        return static_cast<double>(std::clock() - processor_start_) / CLOCKS_PER_SEC;
    }

private:
    using Clock = std::chrono::steady_clock;
    Clock::time_point start_ = Clock::now();
    std::clock_t processor_start_ = std::clock();
};

}  // namespace controlspace
