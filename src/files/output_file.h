// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <string_view>
#include <utility>

namespace controlspace {

/// Throws InputError unless the disk of `path` has room for so many bytes more; where that is not
/// known, it is left to writing.
void require_room(const std::filesystem::path& path, std::uintmax_t bytes);

/// Throws InputError where OutputFile would refuse `path`: a folder, a write-protected file, or in
/// a folder that is not there or is write-protected. Writes nothing, for programs to call it before
/// work that takes long.
void require_writable(const std::filesystem::path& path);

/// A file that is written whole or not at all: the bytes go to a temporary file beside it, which is
/// renamed by `commit`, once the disk has it, and removed without it. A file that is replaced
/// leaves its mode to the new one, and is refused if it is write-protected. Every writer of this
/// program uses this. What is not a regular file is written to directly, and so is standard output
/// (/dev/stdout), whatever it is. Failures, a full disk among them, throw InputError.
class OutputFile {
public:
    explicit OutputFile(const std::filesystem::path& path);
    ~OutputFile();
    OutputFile(const OutputFile&) = delete;
    OutputFile& operator=(const OutputFile&) = delete;

    /// The temporary file for `path` in this process: a program that ends at once removes it.
    static std::filesystem::path partial(const std::filesystem::path& path);

    void write(std::string_view bytes);
    /// Numbers are written so that they read back to the last bit.
    template <class... Args>
    void print(fmt::format_string<Args...> format, Args&&... args) {
        line_.clear();
        fmt::format_to(std::back_inserter(line_), format, std::forward<Args>(args)...);
        write({line_.data(), line_.size()});
    }
    /// The raw bytes of numbers.
    template <class Number>
    void write_raw(const Number* numbers, std::size_t count) {
        write({reinterpret_cast<const char*>(numbers), count * sizeof(Number)});
    }
    template <class Number>
    void write_raw(Number number) {
        write_raw(&number, 1);
    }

    /// Where the bytes go until `commit`, for libraries that open the file themselves.
    const std::filesystem::path& written() const { return written_; }
    /// Writes what is still held back; for files that belong together, before one is committed.
    void finish();
    /// To be called once, last.
    void commit();

private:
    bool close();
    void sync() const;
    [[noreturn]] void fail() const;

    std::filesystem::path target_;
    std::filesystem::path written_;  ///< the temporary file, or the target itself
    std::FILE* file_ = nullptr;
    fmt::memory_buffer line_;
};

}  // namespace controlspace
