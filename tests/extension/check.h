// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdio>

inline int failures = 0;

inline void check(bool holds, const char* what) {
    if (holds) return;
    std::printf("failed: %s\n", what);
    ++failures;
}
