// SPDX-License-Identifier: Apache-2.0
#include "cones/trilinear_lengths.h"

#include <algorithm>
#include <cmath>

#include "controlspace/geometry/extent.h"
#include "controlspace/metric/blend.h"

namespace controlspace {

double TrilinearLengths::at_place(const Point& x) const {
    const auto weights = corner_weights((x - box.low).cwiseQuotient(divisible_edges(box)));
    double length = 0;
    for (std::size_t i = 0; i < 8; ++i) length += weights[i] * at[i];
    return length;
}

double TrilinearLengths::slope() const {
    Vector most = Vector::Zero();
    for (Axis a = 0; a < 3; ++a) {
        const std::size_t high = std::size_t{1} << a;
        for (std::size_t i = 0; i < 8; ++i) {
            if ((i & high) == 0) most[a] = std::max(most[a], std::abs(at[i | high] - at[i]));
        }
    }
    return most.cwiseQuotient(divisible_edges(box)).norm();
}

std::pair<TrilinearLengths, TrilinearLengths> TrilinearLengths::halves() const {
    Axis longest = 0;
    box.edges().maxCoeff(&longest);
    auto both = std::pair(*this, *this);
    const double middle = box.centre()[longest];
    both.first.box.high[longest] = both.second.box.low[longest] = middle;
    // A half, but for rounding.
    const double share = (middle - box.low[longest]) / (box.high[longest] - box.low[longest]);
    const std::size_t high = std::size_t{1} << longest;
    for (std::size_t i = 0; i < 8; ++i) {
        if ((i & high) != 0) continue;
        both.first.at[i | high] = both.second.at[i] = at[i] + share * (at[i | high] - at[i]);
    }
    return both;
}

}  // namespace controlspace
