#pragma once

#include <string>
#include <vector>

namespace controlspace {

/// `rounds` copies of a file, and a third more that are cut off, have bytes flipped, numbers
/// replaced by others that lie, and pieces lost or doubled; the same in every run. The environment
/// variable DAMAGED_FILES multiplies their number.
std::vector<std::string> damaged_copies(const std::string& bytes, int rounds = 100);

}  // namespace controlspace
