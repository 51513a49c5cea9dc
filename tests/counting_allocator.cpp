#include "counting_allocator.h"

#include <atomic>
#include <cstdlib>
#include <new>

namespace {

// In front of every block lies its size.
std::atomic<std::size_t> live = 0;
std::atomic<std::size_t> peak = 0;
constexpr std::size_t header = alignof(std::max_align_t);

}  // namespace

// All forms but the aligned ones are replaced, since sanitizers replace each form on its own.
void* operator new(std::size_t bytes, const std::nothrow_t&) noexcept {
    void* const block = std::malloc(bytes + header);
    if (block == nullptr) return nullptr;
    *static_cast<std::size_t*>(block) = bytes;
    const std::size_t now = live += bytes;
    std::size_t most = peak;
    while (most < now && !peak.compare_exchange_weak(most, now)) {
    }
    return static_cast<char*>(block) + header;
}
void* operator new(std::size_t bytes) {
    void* const memory = operator new(bytes, std::nothrow);
    if (memory == nullptr) throw std::bad_alloc();
    return memory;
}
void* operator new[](std::size_t bytes, const std::nothrow_t&) noexcept {
    return operator new(bytes, std::nothrow);
}
void* operator new[](std::size_t bytes) { return operator new(bytes); }
void operator delete(void* memory) noexcept {
    if (memory == nullptr) return;
    void* const block = static_cast<char*>(memory) - header;
    live -= *static_cast<std::size_t*>(block);
    std::free(block);
}
void operator delete(void* memory, std::size_t) noexcept { operator delete(memory); }
void operator delete[](void* memory) noexcept { operator delete(memory); }
void operator delete[](void* memory, std::size_t) noexcept { operator delete(memory); }

namespace controlspace {

std::size_t live_bytes() { return live; }
std::size_t peak_bytes() { return peak; }
void reset_peak_bytes() { peak = live.load(); }

}  // namespace controlspace
