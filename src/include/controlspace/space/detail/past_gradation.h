// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <type_traits>

#include "controlspace/gradation/detail/regrade.h"
#include "controlspace/space/detail/state.h"

namespace controlspace {

/// Writes or reads which gradation a field has been through, if any.
template <class Past, class State>
void exchange_past(Past& past, State& state) {
    bool is_graded = past.has_value();
    state("past.is_graded", is_graded);
    if constexpr (!std::is_const_v<Past>) {
        past.reset();
        if (is_graded) past.emplace();
    }
    if (!is_graded) return;
    state("past.law", past->options.law, GradationLaw::mean_length);
    state("past.schedule", past->options.schedule, GradationSchedule::sources);
    state("past.neighbourhood", past->options.neighbourhood, Neighbourhood::all);
    state("past.ratio", past->options.ratio);
    state("past.largest_ratio_left", past->largest_ratio_left);
}

}  // namespace controlspace
