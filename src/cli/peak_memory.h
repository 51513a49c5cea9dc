#pragma once

#include <cstddef>

namespace controlspace {

/// Counts the peak of memory anew from here, where the system allows it; otherwise it stays that of
/// the whole program so far.
void restart_peak_memory();

/// Most memory that the program has held since, in bytes, without its children's.
std::size_t peak_memory();

}  // namespace controlspace
