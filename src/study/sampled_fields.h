// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <span>
#include <vector>

#include "controlspace/study/measure.h"

namespace controlspace {

/// Cells along each side of a slice.
constexpr int slice_cells = 200;

/// Writes numbers as a NumPy file (version 1.0, '<f8', C order). The product of `shape` is their
/// count. Throws InputError, naming the file.
void write_npy(const std::filesystem::path& path, std::span<const std::size_t> shape,
               std::span<const double> numbers);

/// The axes of slices, lower one first: x and y, or those of a flat domain.
std::array<Axis, 2> slice_axes(const Box& domain);

/// The cells of `space` that the slice at height `z` cuts, by rising y; none if they are more than
/// `most`, or the space has no cells. In a flat domain the slice is the domain.
std::optional<std::vector<Box>> cells_on_slice(const ControlSpace& space, double z,
                                               std::size_t most);

/// Samples a structure on the slice through the middle of its domain (slice_cells^2 metrics, x
/// fastest) and at the coarse probes, and its reference unless `has_exact`; writes them and the
/// outlines of cells into FOLDER/fields, and names the files. Throws InputError.
FieldFiles write_sampled_fields(const std::filesystem::path& folder, const Finished& finished,
                                bool has_exact);

}  // namespace controlspace
