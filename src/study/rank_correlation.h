// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <vector>

namespace controlspace {

/// Ranks from 1 for the smallest value; equal values share the mean of their ranks.
std::vector<double> average_ranks(std::span<const double> values);

/// Spearman's rho: the correlation of the ranks of two lists of equal length, from -1 to 1. None
/// for fewer than three pairs, and where all values of a list are equal.
std::optional<double> spearman(std::span<const double> a, std::span<const double> b);

}  // namespace controlspace
