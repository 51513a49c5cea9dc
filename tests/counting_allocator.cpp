// SPDX-License-Identifier: Apache-2.0
#include "counting_allocator.h"

#include <atomic>
#include <cstdlib>
#include <new>

namespace {

// In front of every block lies its size.
std::atomic<std::size_t> live = 0;
std::atomic<std::size_t> peak = 0;
constexpr std::size_t header = alignof(std::max_align_t);

void count(std::size_t bytes) {
    const std::size_t now = live += bytes;
    std::size_t most = peak;
    while (most < now && !peak.compare_exchange_weak(most, now)) {
    }
}

}  // namespace

// All forms are replaced, since sanitizers replace each form on its own.
void* operator new(std::size_t bytes, const std::nothrow_t&) noexcept {
    void* const block = std::malloc(bytes + header);
    if (block == nullptr) return nullptr;
    *static_cast<std::size_t*>(block) = bytes;
    count(bytes);
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

// Of a wider alignment, the header takes as much.
void* operator new(std::size_t bytes, std::align_val_t alignment, const std::nothrow_t&) noexcept {
    const auto wide = static_cast<std::size_t>(alignment);
    void* const block = std::aligned_alloc(wide, (bytes + 2 * wide - 1) / wide * wide);
    if (block == nullptr) return nullptr;
    *static_cast<std::size_t*>(block) = bytes;
    count(bytes);
    return static_cast<char*>(block) + wide;
}
void* operator new(std::size_t bytes, std::align_val_t alignment) {
    void* const memory = operator new(bytes, alignment, std::nothrow);
    if (memory == nullptr) throw std::bad_alloc();
    return memory;
}
void* operator new[](std::size_t bytes, std::align_val_t alignment,
                     const std::nothrow_t&) noexcept {
    return operator new(bytes, alignment, std::nothrow);
}
void* operator new[](std::size_t bytes, std::align_val_t alignment) {
    return operator new(bytes, alignment);
}
void operator delete(void* memory, std::align_val_t alignment) noexcept {
    if (memory == nullptr) return;
    void* const block = static_cast<char*>(memory) - static_cast<std::size_t>(alignment);
    live -= *static_cast<std::size_t*>(block);
    std::free(block);
}
void operator delete(void* memory, std::size_t, std::align_val_t alignment) noexcept {
    operator delete(memory, alignment);
}
void operator delete[](void* memory, std::align_val_t alignment) noexcept {
    operator delete(memory, alignment);
}
void operator delete[](void* memory, std::size_t, std::align_val_t alignment) noexcept {
    operator delete(memory, alignment);
}

namespace controlspace {

std::size_t live_bytes() { return live; }
std::size_t peak_bytes() { return peak; }
void reset_peak_bytes() { peak = live.load(); }

}  // namespace controlspace
