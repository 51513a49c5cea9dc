// SPDX-License-Identifier: Apache-2.0
#include "trees/topology/cut_lattice.h"

#include <algorithm>

namespace controlspace {

CutLattice::CutLattice(const Subdivision& subdivision, const Corners& old) {
    const Box& box = subdivision.box;
    constexpr NodeIndex unknown = ~NodeIndex{0}, to_be_set = unknown - 1;
    nodes_.fill(unknown);
    const auto enter = [&](const std::array<int, 3>& step) {
        const int number = step[0] + 3 * step[1] + 9 * step[2];
        const auto at = static_cast<std::size_t>(number);
        if (nodes_[at] != unknown) return at;
        Point x;
        int old_corner = 0;
        bool is_old = true;
        for (Axis a = 0; a < 3; ++a) {
            const int s = step[static_cast<std::size_t>(a)];
            x[a] = s == 0 ? box.low[a] : s == 1 ? subdivision.at[a] : box.high[a];
            old_corner |= (s / 2) << a;
            is_old = is_old && s != 1;
        }
        nodes_[at] = is_old ? old[static_cast<std::size_t>(old_corner)] : to_be_set;
        if (!is_old) new_[count_++] = {at, x};
        return at;
    };
    for (int c = 0; c < subdivision.children(); ++c) {
        for (int i = 0; i < 8; ++i) {
            std::array<int, 3> step{};
            for (Axis a = 0; a < 3; ++a) {
                const auto axis = static_cast<std::size_t>(a);
                const int bit = i >> a & 1;
                const int high = box.low[a] < box.high[a] ? 2 : 0;
                step[axis] = subdivision.cuts[axis] ? subdivision.side(c, a) + bit : high * bit;
            }
            corners_at_[static_cast<std::size_t>(c)][static_cast<std::size_t>(i)] = enter(step);
        }
    }
}

Corners CutLattice::child(int c) const {
    Corners corners;
    std::ranges::transform(corners_at_[static_cast<std::size_t>(c)], corners.begin(),
                           [&](std::size_t at) { return nodes_[at]; });
    return corners;
}

}  // namespace controlspace
