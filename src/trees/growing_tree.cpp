// SPDX-License-Identifier: Apache-2.0
#include "controlspace/trees/detail/growing_tree.h"

#include <fmt/format.h>

#include "controlspace/input_errors.h"

namespace controlspace {

void fail_too_many_leaves() {
    throw InputError("a tree holds 2^30 leaves at most: raise l_min or lower the depth");
}

void fail_too_large(std::size_t bytes, std::size_t max_bytes) {
    constexpr double gib = 1024.0 * 1024 * 1024;
    throw MemoryLimitError(
        bytes,
        fmt::format("the tree would take more than {:.3g} GiB, gradation included: raise tau "
                    "(l_min) or target_delta, or max_memory",
                    static_cast<double>(max_bytes) / gib));
}

std::string depth_shortfall(int max_depth, int deepest) {
    return fmt::format("leaves of level {} are not cut{}", max_depth,
                       max_depth < deepest
                           ? ": raise the depth, or target_delta (within)"
                           : ", the deepest of this structure: raise target_delta (within)");
}

std::string leaves_shortfall(std::size_t max_leaves) {
    return fmt::format("more than {} leaves are needed: raise max_leaves (0: no limit)",
                       max_leaves);
}

std::string limit_shortfall(GrowthStop stop) {
    return stop == GrowthStop::time ? "no time was left" : "no memory was left";
}

void fail_stopped(GrowthStop stop, std::size_t leaves) {
    throw GrowthStopped(
        stop, leaves,
        fmt::format("the tree is not finished: {} with {} leaves", limit_shortfall(stop), leaves));
}

}  // namespace controlspace
