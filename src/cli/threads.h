#pragma once

#include <tbb/global_control.h>

#include <memory>

namespace controlspace {

/// Limits TBB to that many threads during its lifetime; 0: all processors, no limit.
std::unique_ptr<tbb::global_control> limit_threads(int threads);

}  // namespace controlspace
