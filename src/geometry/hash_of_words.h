// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bit>
#include <cstdint>

namespace controlspace {

/// A multiply-xorshift mixer of numbers of 64 bits each.
template <class Words>
std::uint64_t hash_of_words(const Words& words) {
    std::uint64_t hash = 0;
    for (const auto& word : words) {
        hash = (hash ^ std::bit_cast<std::uint64_t>(word)) * 0x9e3779b97f4a7c15u;
        hash ^= hash >> 32;
    }
    return hash;
}

}  // namespace controlspace
