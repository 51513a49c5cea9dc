// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <initializer_list>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "files/output_file.h"
#include "io/text/scanner.h"

namespace controlspace {

/// A keyword of Medit's formats, as a word and as libMeshb's number.
struct MeditKeyword {
    std::string_view word;
    std::int32_t code;
};
inline constexpr MeditKeyword medit_vertices{"Vertices", 4}, medit_edges{"Edges", 5},
    medit_triangles{"Triangles", 6}, medit_required_edges{"RequiredEdges", 14},
    medit_tetrahedra{"Tetrahedra", 8}, medit_solution{"SolAtVertices", 62};

inline constexpr std::size_t medit_vertex_bytes = 3 * sizeof(double) + sizeof(std::int32_t);

/// Reads a Medit mesh or solution, which the first bytes show to be text (.mesh, .sol: words
/// between white space, whatever the lines and the case of letters; # starts a comment) or binary
/// (.meshb, .solb; versions 1 to 4 in either byte order: blocks of a keyword's number, where the
/// next block begins, and data). Counts, indices and offsets are checked against the file's size
/// before they are used.
class MeditReader {
public:
    /// Reads the head; `bytes` and `path` must outlive this.
    MeditReader(std::string_view bytes, const std::filesystem::path& path);

    /// 2 or 3, of what `find` went to.
    std::size_t dimension() const { return dimension_; }

    /// Goes behind `keyword`, whatever stands before, and returns the count of its rows, which is
    /// positive. A row has so many real numbers and integers, or more.
    std::size_t find(const MeditKeyword& keyword, std::size_t reals, std::size_t integers);

    /// To be called after the last row: fails where more numbers follow, as rows then have another
    /// length than they were read with.
    void end_rows();

    /// A number of 32 bits.
    std::int64_t integer(const FilePart& part) { return integer(false, part); }
    /// A number from 1 to `most`, of 64 bits in version 4.
    std::int64_t integer(const FilePart& part, std::int64_t most);
    /// A finite number.
    double number(const FilePart& part);
    /// Passes over a reference, a number without meaning here.
    void skip_reference(const FilePart& part);

    std::string where() const { return data_.where(); }
    template <class... Args>
    [[noreturn]] void fail(fmt::format_string<Args...> text, Args&&... args) const {
        data_.fail(text, std::forward<Args>(args)...);
    }

private:
    /// Reads the head of the next block: whether it is that of `keyword`, of the dimension or
    /// another one. False at the end of the file.
    bool next_block();
    bool is_at(const MeditKeyword& keyword) const;
    std::int64_t integer(bool wide, const FilePart& part);

    std::string_view bytes_;
    Scanner data_;
    std::int64_t version_ = 1;
    std::size_t dimension_ = 0;  ///< 0: not known yet
    std::string_view word_;      ///< the keyword that was read last, in text
    std::int64_t code_ = 0;      ///< the same, in binary data
    std::size_t next_ = 0;       ///< where the next binary block begins
};

/// The numbers of the vertices, of which there are so many, of all elements of a kind, from 0.
template <std::size_t n>
std::vector<std::array<std::uint32_t, n>> read_medit_elements(std::string_view bytes,
                                                              const std::filesystem::path& path,
                                                              const MeditKeyword& keyword,
                                                              std::size_t vertices) {
    // Blocks of elements may be in any order: each kind is searched for from the beginning.
    MeditReader file(bytes, path);
    const auto most = static_cast<std::int64_t>(vertices);
    std::vector<std::array<std::uint32_t, n>> elements(file.find(keyword, 0, n + 1));
    for (std::size_t i = 0; i < elements.size(); ++i) {
        for (std::uint32_t& corner : elements[i]) {
            corner = static_cast<std::uint32_t>(file.integer({keyword.word, i}, most) - 1);
        }
        file.skip_reference({keyword.word, i});
    }
    file.end_rows();
    return elements;
}

/// Writes a Medit mesh or solution: binary where the name ends in b (.meshb, .solb), of version 2,
/// or 3 where `data_bytes`, the size of all rows, does not fit 32 bits; text otherwise.
class MeditWriter {
public:
    MeditWriter(const std::filesystem::path& path, std::size_t data_bytes);

    /// Begins a block of `count` rows of `row_bytes` each in binary files. `head` are numbers
    /// between the count and the rows.
    void begin(const MeditKeyword& keyword, std::size_t count, std::size_t row_bytes,
               std::initializer_list<std::int32_t> head = {});
    /// A row of real numbers or of indices, and its reference if it has one.
    template <class Number>
    void row(std::span<const Number> numbers, std::optional<std::int32_t> reference) {
        if (binary_) {
            file_.write_raw(numbers.data(), numbers.size());
            if (reference) file_.write_raw(*reference);
            return;
        }
        for (const Number x : numbers) file_.print("{} ", x);
        if (reference) file_.print("{}", *reference);
        file_.write("\n");
    }
    /// Ends the file, and writes what is still held back.
    void finish();
    /// Gives the file its name; to be called once, last.
    void commit() { file_.commit(); }

private:
    void begin_block(std::int32_t code, std::size_t size);
    void write_offset(std::size_t offset);

    OutputFile file_;
    bool binary_;
    bool wide_;
    std::size_t size_ = 0;  ///< of the blocks that were begun
};

/// Whether a Medit file of that name is binary: it ends in .meshb or .solb.
bool is_binary_medit_name(const std::filesystem::path& path);

}  // namespace controlspace
