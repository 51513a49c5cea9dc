#pragma once

#include <tbb/global_control.h>

#include <memory>

namespace controlspace {

/// Holds TBB to that many threads for as long as it lives; 0: all processors, no limit.
std::unique_ptr<tbb::global_control> limit_threads(int threads);

}  // namespace controlspace
