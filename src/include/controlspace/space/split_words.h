// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "controlspace/space/split_rule.h"
#include "controlspace/words.h"

namespace controlspace {

template <>
struct Words<SplitRule> {
    static constexpr Word<SplitRule> table[] = {
        {SplitRule::middle, "s_L", "middle of the longest axis"},
        {SplitRule::golden, "s_G", "golden section of the longest axis, nearer to the source"},
        {SplitRule::exact_golden, "s_Gx", "the same with sections to all digits, not to five"},
        {SplitRule::metric, "s_M", "so that the source's part is l_min long in its metric"}};
};

}  // namespace controlspace
