// SPDX-License-Identifier: Apache-2.0
#include "trees/topology/cell_steps.h"

#include <algorithm>
#include <bit>
#include <limits>

#include "vector_clones.h"

namespace controlspace {

namespace {

int bits_of(int cells) { return std::countr_zero(static_cast<unsigned>(cells)); }

}  // namespace

CellSteps::CellSteps(const std::array<Axis, 3>& axes)
    : across_(bits_of(axes[0].cells)), up_(across_ + bits_of(axes[1].cells)) {
    int most_cells = 0;
    double error = 0;
    for (const Axis& axis : axes) {
        most_cells = std::max(most_cells, axis.cells);
        error = std::max(error, axis.error);
    }
    // As many as integers have room for, as long as steps are longer than what quotients are off.
    fraction_bits_ = 30 - bits_of(most_cells);
    while (fraction_bits_ > 0 && error * (1 << fraction_bits_) > 0.5) --fraction_bits_;
    const double steps = 1 << fraction_bits_;
    for (std::size_t a = 0; a < 3; ++a) {
        low_[a] = axes[a].low;
        per_length_[a] = axes[a].per_length * steps;
        most_[a] = (axes[a].cells - 0.5) * steps;
        if (axes[a].cells > 1) continue;
        // One cell holds all places, of an axis without extent too: steps end in its middle.
        low_[a] = -std::numeric_limits<double>::infinity();
        per_length_[a] = 1;
    }
}

// One pass over all coordinates, then one over places: vectors need no rearranging in the longer.
CONTROLSPACE_VECTOR_CLONES
void CellSteps::find(std::span<const Point> x, std::span<int> cells) const {
    static_assert(sizeof(Point) == 3 * sizeof(double));
    constexpr std::size_t places = 128;
    constexpr std::size_t lanes = 12;  // four places, which fill vectors of any length
    std::array<double, lanes> low, per_length, most;
    for (std::size_t l = 0; l < lanes; ++l) {
        low[l] = low_[l % 3];
        per_length[l] = per_length_[l % 3];
        most[l] = most_[l % 3];
    }
    std::array<int, 3 * places> steps;
    for (std::size_t first = 0; first < x.size(); first += places) {
        const std::size_t count = std::min(places, x.size() - first);
        const double* coordinates = x[first].data();
        for (std::size_t i = 0; i < 3 * count; i += lanes) {
            const std::size_t rest = 3 * count - i;
            for (std::size_t l = 0; l < std::min(lanes, rest); ++l) {
                double s = (coordinates[i + l] - low[l]) * per_length[l];
                s = s > 0 ? s : 0;
                s = s < most[l] ? s : most[l];
                steps[i + l] = static_cast<int>(s);
            }
        }
        for (std::size_t p = 0; p < count; ++p) {
            const auto sx = static_cast<unsigned>(steps[3 * p]);
            const auto sy = static_cast<unsigned>(steps[3 * p + 1]);
            const auto sz = static_cast<unsigned>(steps[3 * p + 2]);
            cells[first + p] = cell_at(sx, sy, sz);
        }
    }
}

}  // namespace controlspace
