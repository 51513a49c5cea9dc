#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

namespace controlspace {

/// Reads the text of an ASCII Medit file (.mesh, .sol): words between white space, whatever the
/// lines; # starts a comment. What is wrong throws InputError "name:line: what".
class MeditWords {
public:
    /// Reads the head; `text` and `path` must outlive this.
    MeditWords(std::string_view text, const std::filesystem::path& path);

    /// The next word; empty at the end.
    std::string_view word();

    /// Goes behind the keyword, checking the dimension on the way.
    void find(std::string_view keyword);

    std::uint64_t count(std::string_view what);

    /// A count of rows with that many numbers each, as the rest of the file can hold; not 0.
    std::size_t rows(std::string_view what, std::size_t reals, std::size_t integers);

    /// A finite number of row `index` (0-based) of `what`.
    double number(std::string_view what, std::size_t index);

    /// Passes over the reference of row `index`, a number without meaning here.
    void skip_reference(std::string_view what, std::size_t index) { number(what, index); }

    /// A whole number of row `index` (0-based) of `what`, from 1 to `most`.
    std::uint64_t index_up_to(std::uint64_t most, std::string_view what, std::size_t index);

    [[noreturn]] void fail(const std::string& what) const;

private:
    std::string_view row_word(std::string_view what, std::size_t index);

    std::string_view text_;
    const std::filesystem::path& path_;
    std::size_t at_ = 0;
    std::size_t line_ = 1;
};

}  // namespace controlspace
