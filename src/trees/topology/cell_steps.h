// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <span>

#include "controlspace/geometry/point.h"

namespace controlspace {

/// Numbers the cells of a uniform grid, x fastest, with 2^n cells along each axis.
///
/// It counts in steps of 2^-fraction_bits cells. The computed number of steps never falls as a
/// coordinate grows, and is less than one off at planes; so a place whose steps are not the last
/// before a plane nor the first behind it is on the side of that plane that they say.
class CellSteps {
public:
    /// Cells along one axis.
    struct Axis {
        double low = 0;
        double per_length = 0;
        int cells = 1;
        double error = 0;  ///< most that the quotient at a plane is off from the plane's number
    };

    CellSteps() = default;
    explicit CellSteps(const std::array<Axis, 3>& axes);

    /// Numbers of the cells that hold places; negative where a place is so close to a plane that it
    /// has to be compared with it. A place outside is taken for the nearest one inside.
    void find(std::span<const Point> x, std::span<int> cells) const;
    /// The same for one place, which is not worth a call.
    int find(const Point& x) const {
        const auto steps = [&](std::size_t a) {
            double s = (x.data()[a] - low_[a]) * per_length_[a];
            s = s > 0 ? s : 0;
            return static_cast<unsigned>(static_cast<int>(s < most_[a] ? s : most_[a]));
        };
        return cell_at(steps(0), steps(1), steps(2));
    }

private:
    int cell_at(unsigned sx, unsigned sy, unsigned sz) const {
        const unsigned fraction = (1u << fraction_bits_) - 1;
        const unsigned near =
            std::min(std::min((sx + 1) & fraction, (sy + 1) & fraction), (sz + 1) & fraction);
        const unsigned cell =
            sx >> fraction_bits_ | sy >> fraction_bits_ << across_ | sz >> fraction_bits_ << up_;
        return near > 1 ? static_cast<int>(cell) : -1;
    }

    std::array<double, 3> low_{}, per_length_{}, most_{};  // in steps
    int fraction_bits_ = 0;
    int across_ = 0;  // bits that number cells along x
    int up_ = 0;      // the same along x and y
};

}  // namespace controlspace
