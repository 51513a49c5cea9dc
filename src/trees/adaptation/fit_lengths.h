// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "controlspace/geometry/box.h"
#include "space/goal_field.h"

namespace controlspace {

/// Fits lengths at the nodes of cells, between the eight of which they are trilinear, in the order
/// of controlspace::corner, to an isotropic field (GoalField::has_ranges): where the field's own
/// values at the nodes are too long between them, as those of a convex function are, they get
/// shorter, so that the largest factors above and below the field in the cells around a node become
/// alike. Cells may share nodes; in a flat domain nodes count twice.
///
/// What is kept everywhere has to be shown by bounds: here cells are compared at 5 x 5 x 5 places,
/// on their faces and corners too. The same bits on any number of threads.
class LengthFit {
public:
    /// It takes some 600 bytes for each cell; more cells are not to be fitted.
    static constexpr std::size_t most_cells = std::size_t{1} << 18;

    /// The field must outlive it.
    explicit LengthFit(const GoalField& field) : field_(field) {}

    /// Evaluates the field in cells, which are new or have another box than before. `boxes` are
    /// those of the cells with these numbers.
    void enter(std::span<const std::uint32_t> numbers, std::span<const Box> boxes);
    /// Sets `lengths` to the field, and then fits them, where cells can be brought within
    /// `allowed`, a factor. Cells that the field's own values keep within it stay there; cells that
    /// no fit brings within it are left out, so that they spoil no others. Nodes of all cells that
    /// were entered, by their numbers.
    ///
    /// Returns the largest factor that is left, either way; infinite where cells were left out.
    double fit(std::span<const std::array<std::uint32_t, 8>> nodes, double allowed,
               std::span<double> lengths) const;

private:
    // In vectors, the last ones empty.
    static constexpr std::size_t lanes = 16;
    static constexpr std::size_t along = 5, places = along * along * along;
    static constexpr std::size_t padded = (places + lanes - 1) / lanes * lanes;
    struct Samples {
        std::array<double, 8> at_corners;
        std::array<float, padded> inverse;  ///< of lengths, in units of the first corner's
    };
    struct Range;
    struct Weights;
    static const Weights& weights();
    Range range_of(const Samples& cell, const std::array<std::uint32_t, 8>& nodes,
                   std::span<const double> lengths) const;

    const GoalField& field_;
    std::vector<Samples> samples_;  // of the cells
};

}  // namespace controlspace
