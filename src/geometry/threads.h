// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cstddef>

namespace controlspace {

/// How many threads a loop in parallel may have here.
inline std::size_t threads_allowed() {
    const auto arena = static_cast<std::size_t>(tbb::this_task_arena::max_concurrency());
    return std::min(
        arena, tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism));
}

}  // namespace controlspace
