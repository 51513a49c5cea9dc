// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

namespace controlspace {

// A program that links counting_allocator.cpp counts what operator new gives out.

/// Bytes allocated and not yet freed.
std::size_t live_bytes();

/// Most of them at any time since the last reset_peak_bytes().
std::size_t peak_bytes();
void reset_peak_bytes();

}  // namespace controlspace
