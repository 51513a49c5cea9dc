// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <cstddef>

namespace controlspace {

/// Calls visit(i) for i from 0 to n - 1, on all of TBB's threads; each works with copies of
/// `visit`.
template <class Visit>
void in_parallel(std::size_t n, const Visit& visit) {
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, n, 16), [&](const auto& part) {
        Visit own = visit;
        for (std::size_t i = part.begin(); i < part.end(); ++i) own(i);
    });
}

}  // namespace controlspace
