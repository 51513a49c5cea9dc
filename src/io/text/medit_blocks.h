#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

namespace controlspace {

/// Reads a binary Medit file (.meshb, .solb) of version 1 to 4, in either byte order, with the
/// calls of MeditWords. The file is a cookie, the version, and blocks: a keyword's number, where
/// the next block begins, and the data. Counts, indices and offsets are checked against the file's
/// size before anything is made of them. What is wrong throws InputError "name, byte n: what".
class MeditBlocks {
public:
    /// Whether a file that begins so is binary.
    static bool are_in(std::string_view bytes);

    /// Reads the head; `bytes` and `path` must outlive this.
    MeditBlocks(std::string_view bytes, const std::filesystem::path& path);

    /// Goes to the data of a block, checking the dimension on the way.
    void find(std::string_view keyword);

    /// A 32-bit count, not negative.
    std::uint64_t count(std::string_view what);
    std::size_t rows(std::string_view what, std::size_t reals, std::size_t integers);
    double number(std::string_view what, std::size_t index);
    void skip_reference(std::string_view what, std::size_t index);
    std::uint64_t index_up_to(std::uint64_t most, std::string_view what, std::size_t index);

    [[noreturn]] void fail(const std::string& what) const;

private:
    /// The next number as it lies in the file, in the byte order of this machine.
    template <class Number>
    Number take(std::string_view what);
    /// A signed number of one of two widths.
    std::int64_t integer(bool wide, std::string_view what);

    std::string_view bytes_;  ///< up to the end of the block that is read
    std::size_t file_size_;
    const std::filesystem::path& path_;
    std::size_t at_ = 0;
    bool swapped_;
    std::uint64_t version_ = 1;
};

}  // namespace controlspace
