// SPDX-License-Identifier: Apache-2.0
#include "geometry/large_pages.h"

#include <sys/mman.h>

#include <cstdint>

namespace controlspace {
namespace {

constexpr std::size_t page = 4096;

std::size_t bytes_to_next_page(const void* begin) {
    const std::size_t before = reinterpret_cast<std::uintptr_t>(begin) % page;
    return before == 0 ? 0 : page - before;
}

}  // namespace

void request_large_pages([[maybe_unused]] void* begin, [[maybe_unused]] std::size_t bytes) {
#ifdef MADV_HUGEPAGE
    constexpr std::size_t worthwhile = std::size_t{4} << 20;
    if (bytes < worthwhile) return;
    const std::size_t skipped = bytes_to_next_page(begin);
    // No matter if it refuses.
    madvise(static_cast<char*>(begin) + skipped, bytes - skipped, MADV_HUGEPAGE);
#endif
}

void give_back(void* begin, std::size_t bytes) {
    const std::size_t skipped = bytes_to_next_page(begin);
    if (bytes < skipped + page) return;
    // No matter if it refuses.
    madvise(static_cast<char*>(begin) + skipped, (bytes - skipped) / page * page, MADV_DONTNEED);
}

}  // namespace controlspace
