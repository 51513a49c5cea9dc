// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "controlspace/geometry/box.h"
#include "controlspace/geometry/subdivision.h"
#include "controlspace/sources/point_source.h"

namespace controlspace {

/// Where a kd-tree cuts a leaf (paper §3.1). Lengths are those in the metric of the source for
/// which the leaf is cut; of axes that are equally long z is cut before y before x.
///
/// Lengths are compared as computed, without a tolerance. Under s_M many edges differ from each
/// other and from l_min by round-off alone, so tree sizes are sensitive to the order of operations;
/// the published ones differ by up to 6 %. A tolerance of 1e-9 on l_min would more than halve them.
enum class SplitRule {
    middle,  ///< s_L: middle of the longest axis
    golden,  ///< s_G: of the two golden sections of the longest axis the one nearer to the source,
             ///< the upper one for a source in the middle
    metric,  ///< s_M: so that the part with the source is l_min long, or the cut is half of l_min
             ///< beyond the source; peels slabs, so its depth grows linearly
    exact_golden,  ///< s_Gx: s_G with sections to double precision instead of five digits
};

/// The cut of `box` for `source`, which lies in it.
Subdivision cut(SplitRule rule, const Box& box, const PointSource& source, double l_min);

}  // namespace controlspace
