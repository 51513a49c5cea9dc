// SPDX-License-Identifier: Apache-2.0
#pragma once

/// Before a function: compiled for processors with vectors of 512, 256 and 128 bits; the program
/// takes what the processor has when it starts. Answers are the same: nothing is contracted.
#if defined(__x86_64__) && defined(__linux__) && defined(__GNUC__) && !defined(__clang__) && \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__) && !defined(__AVX2__) && \
    __GNUC__ >= 12
#define CONTROLSPACE_VECTOR_CLONES \
    __attribute__((target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")))
#else
#define CONTROLSPACE_VECTOR_CLONES
#endif
