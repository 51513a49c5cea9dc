// SPDX-License-Identifier: Apache-2.0
#include "cli/peak_memory.h"

#include <malloc.h>

#include <fstream>
#include <string>

namespace controlspace {

void restart_peak_memory() {
    // Memory that was freed but not returned to the system would count.
    ::malloc_trim(0);
    std::ofstream("/proc/self/clear_refs") << "5";
}

std::size_t peak_memory() {
    std::ifstream status("/proc/self/status");
    for (std::string word; status >> word;) {
        std::size_t kibibytes = 0;
        if (word == "VmHWM:" && status >> kibibytes) return kibibytes * 1024;
    }
    return 0;
}

}  // namespace controlspace
