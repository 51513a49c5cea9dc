#include "controlspace/geometry/detail/large_pages.h"

#include <sys/mman.h>

#include <cstdint>

namespace controlspace {

void request_large_pages([[maybe_unused]] void* begin, [[maybe_unused]] std::size_t bytes) {
#ifdef MADV_HUGEPAGE
    constexpr std::size_t page = 4096, worthwhile = std::size_t{4} << 20;
    if (bytes < worthwhile) return;
    const std::size_t before = reinterpret_cast<std::uintptr_t>(begin) % page;
    const std::size_t skipped = before == 0 ? 0 : page - before;
    // No matter if it refuses.
    madvise(static_cast<char*>(begin) + skipped, bytes - skipped, MADV_HUGEPAGE);
#endif
}

}  // namespace controlspace
