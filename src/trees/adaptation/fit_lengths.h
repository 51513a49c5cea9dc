// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "controlspace/geometry/box.h"
#include "space/goal_field.h"

namespace controlspace {

/// A cell whose lengths are trilinear between those of eight nodes, which it may share with others,
/// in the order of controlspace::corner. In a flat domain nodes count twice.
struct FittedCell {
    Box box;
    std::array<std::uint32_t, 8> nodes;
};

/// What is compared in one cell takes so many bytes; cells above the most are not fitted.
constexpr std::size_t bytes_to_fit_a_cell = 512;
constexpr std::size_t most_cells_to_fit = std::size_t{1} << 18;

/// Sets the lengths of nodes to an isotropic field (GoalField::has_ranges), and fits them to it:
/// where the field's own values at the nodes are too long between them, as those of a convex
/// function are, they get shorter, so that the largest factors above and below the field in the
/// cells around a node become alike. Cells where the field's own values are off by more than twice
/// what is allowed, as a logarithm, are left out: no fit helps them, and they would spoil others.
///
/// Returns the largest factor between the two that is left, either way, at 5 x 5 x 5 places of the
/// cells, their faces and corners among them; infinite where cells were left out. It is sampled;
/// what is kept everywhere has to be shown by bounds. The same bits on any number of threads.
double fit_lengths(const GoalField& field, std::span<const FittedCell> cells, double allowed,
                   std::span<double> lengths);

}  // namespace controlspace
