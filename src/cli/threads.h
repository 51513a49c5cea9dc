// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tbb/global_control.h>

#include <memory>

namespace controlspace {

/// Limits TBB to that many threads during its lifetime; 0: all processors, no limit.
inline std::unique_ptr<tbb::global_control> limit_threads(int threads) {
    if (threads == 0) return nullptr;
    return std::make_unique<tbb::global_control>(tbb::global_control::max_allowed_parallelism,
                                                 static_cast<std::size_t>(threads));
}

}  // namespace controlspace
