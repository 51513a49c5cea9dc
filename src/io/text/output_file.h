#pragma once

#include <cstdio>
#include <filesystem>
#include <string_view>

namespace controlspace {

/// A file that is either written whole or not at all: the text goes to a temporary file beside it,
/// which takes its name on `commit` and is removed otherwise. What is not a regular file
/// is written to directly, and so is standard output (/dev/stdout), whatever it is. Failures, a
/// full disk among them, throw InputError.
class OutputFile {
public:
    explicit OutputFile(const std::filesystem::path& path);
    ~OutputFile();
    OutputFile(const OutputFile&) = delete;
    OutputFile& operator=(const OutputFile&) = delete;

    /// Where the text for `path` goes until `commit`, in this process: to be removed by who ends
    /// the program at once.
    static std::filesystem::path partial(const std::filesystem::path& path);

    void write(std::string_view text);
    /// Where the text goes until `commit`, for writers that open the file themselves.
    const std::filesystem::path& written() const { return written_; }
    /// To be called once, last.
    void commit();

private:
    [[noreturn]] void fail() const;

    std::filesystem::path target_;
    std::filesystem::path written_;  ///< the temporary file, or the target itself
    std::FILE* file_ = nullptr;
};

}  // namespace controlspace
