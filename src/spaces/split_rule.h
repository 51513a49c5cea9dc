#pragma once

#include "geometry/box.h"
#include "sources/point_source.h"
#include "spaces/subdivision.h"

namespace controlspace {

/// Where a kd-tree cuts a leaf (paper §3.1.1). Lengths are those in the metric of the source for
/// which the leaf is cut.
///
/// Axes within a relative 1e-9 of the longest are equally long: of them z is cut before y before
/// x. So the tree does not hang on how the lengths were rounded.
enum class SplitRule {
    middle,  ///< s_L: middle of the longest axis
    golden,  ///< s_G: of the two golden sections of the longest axis the one nearer to the source
    metric,  ///< s_M: so that the part with the source is l_min long, or the cut is half of l_min
             ///< beyond the source; peels slabs, so its depth grows linearly
};

/// The cut of `box` for `source`, which lies in it.
Subdivision cut(SplitRule rule, const Box& box, const PointSource& source, double l_min);

}  // namespace controlspace
