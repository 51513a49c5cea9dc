// SPDX-License-Identifier: Apache-2.0
#include "controlspace/space/space_options.h"

#include <fmt/format.h>

#include <cmath>

#include "controlspace/error.h"
#include "controlspace/geometry/extent.h"
#include "controlspace/gradation/grade.h"
#include "controlspace/sources/point_source.h"
#include "require_known.h"

namespace controlspace {

namespace {

void require_positive(const char* name, double value) {
    if (!std::isfinite(value) || !(value > 0)) {
        throw InputError(fmt::format("{} is {}: give a finite value above 0", name, value));
    }
}

void require_not_negative(const char* name, double value) {
    if (!std::isfinite(value) || value < 0) {
        throw InputError(fmt::format("{} is {}: give 0 or a finite value above", name, value));
    }
}

void require_depth(const char* name, std::optional<int> depth, int deepest) {
    if (depth && (*depth < 0 || *depth > deepest)) {
        throw InputError(fmt::format("{} is {}: give a value from 0 to {}", name, *depth, deepest));
    }
}

}  // namespace

void require_valid(const SpaceOptions& options) {
    require_extent(options.domain);
    require_known("split", options.split, SplitRule::exact_golden);
    require_known("quadratic_form", options.quadratic_form, QuadraticForm::published);
    require_known("intersection", options.intersection, IntersectionRule::in_turn);
    require_valid(GradationOptions{.ratio = options.ratio});
    require_positive("l_min (tau)", options.l_min);
    require_positive("the insertion tolerance (epsilon)", options.tolerance);
    require_not_negative("voxel", options.voxel);
    if (!is_length(options.h_max)) {
        throw InputError(fmt::format("h_max is {}: give a value from {} to {}", options.h_max,
                                     1 / largest_magnitude, largest_magnitude));
    }
    require_not_negative("prune_delta", options.prune_delta);
    require_depth("the depth of kd-trees", options.kd_depth, deepest_kd_level);
    require_depth("the depth of octrees", options.octree_depth, deepest_octree_level);
}

}  // namespace controlspace
