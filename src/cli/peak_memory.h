// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

namespace controlspace {

/// Restarts the peak of memory, where the system allows it; otherwise it remains that of the whole
/// run.
void restart_peak_memory();

/// Largest resident memory of the program since then [bytes], without child processes.
std::size_t peak_memory();

}  // namespace controlspace
