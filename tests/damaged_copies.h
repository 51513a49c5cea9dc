// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>

namespace controlspace {

/// Calls `visit` with `rounds` copies of a file, and a third more that are cut off, have bytes
/// flipped, numbers replaced by others that lie, and pieces lost or doubled; the same in every run.
/// The environment variable DAMAGED_FILES multiplies the number of those that are not only cut off,
/// and DAMAGED_FROM is the seed of the first of them (0). Returns how many there were.
int for_each_damaged_copy(const std::string& bytes, int rounds,
                          const std::function<void(const std::string&)>& visit);

}  // namespace controlspace
