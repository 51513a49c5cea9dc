// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>

#include "files/text_file.h"
#include "refuse.h"

namespace controlspace {

/// What is being read, for messages: "Vertices", or row `row` (0-based) of it, "vertex 3".
struct FilePart {
    std::string_view name;
    std::optional<std::size_t> row = {};

    FilePart(const char* whole) : name(whole) {}
    FilePart(std::string_view whole) : name(whole) {}
    FilePart(const std::string& whole) : name(whole) {}
    FilePart(std::string_view rows, std::size_t index) : name(rows), row(index) {}
    std::string text() const;
};

/// Reads a file whose bytes are in memory from front to back: words and lines of a text, numbers
/// of binary data. Errors are InputError and name the place, "name:line: what" in text and
/// "name, byte n: what" in binary data.
class Scanner {
public:
    static constexpr std::string_view blanks = " \t\r\n\v\f";

    /// A comment begins with one of `line_comment` and ends with the line; /* */ encloses one where
    /// `line_comment` is "//". The bytes and the path must outlive this.
    Scanner(std::string_view bytes, const std::filesystem::path& path,
            std::string_view line_comment = {})
        : bytes_(bytes), path_(path), line_comment_(line_comment) {}

    /// Whether the data are binary from here on, and whether the bytes of numbers are reversed.
    void set_binary(bool binary, bool swapped = false) {
        binary_ = binary;
        swapped_ = swapped;
    }
    bool is_binary() const { return binary_; }

    std::size_t at() const { return at_; }
    void go_to(std::size_t at) { at_ = at; }
    /// Nothing is read from byte `end` on, until this is called again.
    void set_end(std::size_t end) { bytes_ = {bytes_.data(), end}; }
    /// What has not been read yet.
    std::string_view rest() const { return bytes_.substr(at_); }
    const std::filesystem::path& path() const { return path_; }

    // Text. A word, a line or a separator that was read last is the place of errors.

    void skip_blanks();
    /// The next word, which ends before one of `separators`; empty at the end of the file.
    std::string_view word(std::string_view separators = blanks);
    /// The rest of the line, without its end.
    std::string_view line();
    /// Whether `what` comes next, which is then passed.
    bool accept(std::string_view what);
    void expect(std::string_view what);

    // Text and binary data.

    /// The next number: a word that ends before one of `separators`, or the bytes of a `Number`.
    template <class Number>
    Number number(const FilePart& part, std::string_view separators = blanks) {
        Number number{};
        if (binary_) {
            std::array<char, sizeof(Number)> raw;
            if (rest().size() < raw.size()) fail_end_within(part);
            std::memcpy(raw.data(), rest().data(), raw.size());
            if (swapped_) std::reverse(raw.begin(), raw.end());
            std::memcpy(&number, raw.data(), raw.size());
            at_ += raw.size();
        } else if (const auto w = word(separators); !parse_number(w, number)) {
            fail_number(part, w, std::is_integral_v<Number>);
        }
        return number;
    }

    /// Throws unless the rest can hold `count` of `what`, each of `bytes` or more: to be called
    /// before memory is allocated for them.
    void require_room(std::string_view what, std::uint64_t count, std::size_t bytes) const;

    /// "name:line" or "name, byte n".
    std::string where() const;
    template <class... Args>
    [[noreturn]] void fail(fmt::format_string<Args...> text, Args&&... args) const {
        refuse_at(where(), text, std::forward<Args>(args)...);
    }

private:
    [[noreturn]] void fail_end_within(const FilePart& part) const;
    [[noreturn]] void fail_number(const FilePart& part, std::string_view word,
                                  bool is_integral) const;

    std::string_view bytes_;
    const std::filesystem::path& path_;
    std::string_view line_comment_;
    std::size_t at_ = 0;
    std::size_t token_ = 0;  ///< beginning of the word or line that was read last
    bool binary_ = false;
    bool swapped_ = false;
};

}  // namespace controlspace
