#include "controlspace/geometry/detail/large_pages.h"

#include <sys/mman.h>

#include <cstdint>

namespace controlspace {
namespace {

constexpr std::uintptr_t page = 4096;

}  // namespace

void request_large_pages([[maybe_unused]] void* begin, [[maybe_unused]] std::size_t bytes) {
#ifdef MADV_HUGEPAGE
    constexpr std::size_t worthwhile = std::size_t{4} << 20;
    if (bytes < worthwhile) return;
    const std::size_t before = reinterpret_cast<std::uintptr_t>(begin) % page;
    const std::size_t skipped = before == 0 ? 0 : page - before;
    // No matter if it refuses.
    madvise(static_cast<char*>(begin) + skipped, bytes - skipped, MADV_HUGEPAGE);
#endif
}

void give_back(void* begin, std::size_t bytes) {
    const auto first = (reinterpret_cast<std::uintptr_t>(begin) + page - 1) / page * page;
    const auto end = (reinterpret_cast<std::uintptr_t>(begin) + bytes) / page * page;
    // No matter if it refuses.
    if (first < end) madvise(reinterpret_cast<void*>(first), end - first, MADV_DONTNEED);
}

}  // namespace controlspace
