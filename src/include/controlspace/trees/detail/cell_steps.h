#pragma once

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

private:
    std::array<double, 3> low_{}, per_length_{}, most_{};  // in steps
    int fraction_bits_ = 0;
    int across_ = 0;  // bits that number cells along x
    int up_ = 0;      // the same along x and y
};

}  // namespace controlspace
