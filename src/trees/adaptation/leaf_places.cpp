// SPDX-License-Identifier: Apache-2.0
#include "trees/adaptation/leaf_places.h"

#include <algorithm>

namespace controlspace {

LeafPlaces::LeafPlaces() {
    std::size_t next = 0;
    // By how many coordinates stand at the middle: corners 0, centre 3, faces 2, edges 1.
    for (const int middles : {0, 3, 2, 1}) {
        for (int i = 0; i < 27; ++i) {
            const std::array<int, 3> step{i % 3, i / 3 % 3, i / 9};
            if (std::count(step.begin(), step.end(), 1) != middles) continue;
            for (Axis a = 0; a < 3; ++a) at[next][a] = 0.5 * step[static_cast<std::size_t>(a)];
            ++next;
        }
    }
    next = 0;
    for (const int faces_met : {2, 1}) {
        for (int i = 0; i < 64; ++i) {
            const std::array<int, 3> step{i % 4, i / 4 % 4, i / 16};
            constexpr std::array<double, 4> fraction{0, 0.25, 0.75, 1};
            const auto met =
                std::count_if(step.begin(), step.end(), [](int k) { return k == 0 || k == 3; });
            if (met != faces_met) continue;
            for (Axis a = 0; a < 3; ++a) {
                const auto k = static_cast<std::size_t>(step[static_cast<std::size_t>(a)]);
                at_between[next][a] = fraction[k];
            }
            ++next;
        }
    }
}

const LeafPlaces& leaf_places() {
    static const LeafPlaces places;
    return places;
}

}  // namespace controlspace
