// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/mman.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <string>
#include <string_view>

namespace controlspace {

/// A file in memory, with a path, for readers that take one.
class MemoryFile {
public:
    MemoryFile() : descriptor_(::memfd_create("fuzz", 0)) {
        if (descriptor_ < 0) std::abort();
    }
    MemoryFile(const MemoryFile&) = delete;
    MemoryFile& operator=(const MemoryFile&) = delete;
    ~MemoryFile() { ::close(descriptor_); }

    /// The file with these bytes alone.
    std::filesystem::path with(std::string_view bytes) {
        const auto size = static_cast<ssize_t>(bytes.size());
        if (::ftruncate(descriptor_, 0) != 0 ||
            ::pwrite(descriptor_, bytes.data(), bytes.size(), 0) != size) {
            std::abort();
        }
        return "/proc/self/fd/" + std::to_string(descriptor_);
    }

private:
    int descriptor_;
};

}  // namespace controlspace
