#include "gmsh/msh_counts.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

#include "controlspace/error.h"
#include "io/text/text_file.h"

namespace controlspace {
namespace {

/// Walks through a file section by section. All counts of format 4.1 are 64-bit numbers, or words
/// of a text.
class Walk {
public:
    Walk(std::string_view file, const std::filesystem::path& path) : file_(file), path_(path) {}

    void check() {
        read_format();
        while (find_section()) {
            if (section_ == "Nodes") check_blocks(true);
            if (section_ == "Elements") check_blocks(false);
            if (section_ == "NodeData") check_data();
        }
    }

private:
    void read_format() {
        if (!file_.starts_with("$MeshFormat")) fail("does not start with $MeshFormat");
        next_line();
        const std::vector<std::string_view> words = words_of(next_line());
        if (words.size() != 3) fail("a line of three words expected: version, type and size");
        if (words[0] != "4.1") {
            fail(fmt::format("format {}: only 4.1 can be read, save it as that", quote(words[0])));
        }
        binary_ = words[1] == "1";
        if (!binary_) return;
        if (take<std::int32_t>("the byte order") != 1) fail("another byte order: save it here");
        next_line();
    }

    /// Goes behind the next line "$Section".
    bool find_section() {
        while (at_ < file_.size()) {
            const std::size_t begin = file_.find("\n$", at_ == 0 ? 0 : at_ - 1);
            if (begin == std::string_view::npos) return false;
            at_ = begin + 2;
            const auto words = words_of(next_line());
            section_ = words.empty() ? "" : std::string(words.front());
            if (!section_.starts_with("End")) return true;
        }
        return false;
    }

    struct Block {
        std::uint64_t dimension;
        std::uint64_t kind;  ///< whether nodes are parametric; the type of elements
        std::uint64_t count;
    };

    Block read_block() {
        constexpr std::string_view what = "a block";
        if (binary_) {
            const auto word = [&] { return static_cast<std::uint64_t>(take<std::int32_t>(what)); };
            const std::uint64_t dimension = word();
            word();  // the entity
            const std::uint64_t kind = word();
            return {dimension, kind, take<std::uint64_t>(what)};
        }
        const auto words = words_of(next_line());
        if (words.size() != 4) fail("a line of four numbers expected, which begins a block");
        return {number_in(words[0]), number_in(words[2]), number_in(words[3])};
    }

    std::uint64_t corners_of(std::uint64_t type) const {
        constexpr std::array<std::uint8_t, 20> corners{0, 2,  3,  4,  4,  8, 6, 5,  3,  6,
                                                       9, 10, 27, 18, 14, 1, 8, 20, 15, 13};
        if (type == 0 || type >= corners.size()) {
            fail(fmt::format("elements of type {}: only those of order 1 and 2 can be read", type));
        }
        return corners[type];
    }

    void check_blocks(bool nodes) {
        const std::vector<std::uint64_t> head = numbers(4);
        std::uint64_t left = head[1];
        require_room(head[0] + left, 1);
        for (std::uint64_t block = 0; block < head[0]; ++block) {
            const Block b = read_block();
            if (b.count > left) fail(fmt::format("a block of {}, but {} are left", b.count, left));
            left -= b.count;
            const std::uint64_t parameters = b.kind != 0 ? b.dimension : 0;
            const std::uint64_t numbers = nodes ? 4 + parameters : 1 + corners_of(b.kind);
            require_room(b.count, numbers * (binary_ ? sizeof(std::uint64_t) : 2));
            if (binary_) {
                at_ += b.count * numbers * sizeof(std::uint64_t);
            } else {
                for (std::uint64_t i = 0; i < b.count * (nodes ? 2 : 1); ++i) next_line();
            }
        }
        if (left > 0) fail(fmt::format("{} are in no block", left));
    }

    void check_data() {
        for (int kind = 0; kind < 3; ++kind) {  // texts, reals, integers
            const std::uint64_t count = number_in(next_line());
            require_room(count, 1);
            for (std::uint64_t i = 0; i < count; ++i) {
                const std::string_view line = next_line();
                if (kind == 2 && i == 2) require_room(number_in(line), binary_ ? 12 : 2);
            }
        }
    }

    void require_room(std::uint64_t count, std::uint64_t bytes_each) const {
        if (count <= (file_.size() - at_) / bytes_each) return;
        fail(fmt::format("{} {}, but the rest of the file can hold {} at most: is it cut off?",
                         section_, count, (file_.size() - at_) / bytes_each));
    }

    std::vector<std::uint64_t> numbers(std::size_t count) {
        std::vector<std::uint64_t> all;
        if (binary_) {
            for (std::size_t i = 0; i < count; ++i) all.push_back(take<std::uint64_t>("a count"));
            return all;
        }
        for (const std::string_view word : words_of(next_line())) all.push_back(number_in(word));
        if (all.size() != count) fail(fmt::format("{} counts expected", count));
        return all;
    }
    std::uint64_t number_in(std::string_view text) const {
        const auto words = words_of(text);
        std::uint64_t n = 0;
        if (words.size() != 1 || !parse_number(words[0], n)) {
            fail(fmt::format("{} instead of a count", quote(text)));
        }
        return n;
    }

    std::vector<std::string_view> words_of(std::string_view line) const {
        constexpr std::string_view blanks = " \t\r";
        std::vector<std::string_view> words;
        for (std::size_t at = line.find_first_not_of(blanks); at < line.size();) {
            const std::size_t end = std::min(line.find_first_of(blanks, at), line.size());
            words.push_back(line.substr(at, end - at));
            at = line.find_first_not_of(blanks, end);
        }
        return words;
    }

    std::string_view next_line() {
        if (at_ >= file_.size()) fail("the file ends early: is it cut off?");
        const std::size_t end = std::min(file_.find('\n', at_), file_.size());
        const std::string_view line = file_.substr(at_, end - at_);
        at_ = std::min(end + 1, file_.size());
        return line;
    }

    template <class Number>
    Number take(std::string_view what) {
        Number number;
        if (file_.size() - at_ < sizeof number) {
            fail(fmt::format("the file ends within {}: is it cut off?", what));
        }
        std::memcpy(&number, file_.data() + at_, sizeof number);
        at_ += sizeof number;
        return number;
    }

    [[noreturn]] void fail(const std::string& what) const {
        if (binary_) throw InputError(fmt::format("{}, byte {}: {}", path_.string(), at_, what));
        const auto read = file_.begin() + static_cast<std::ptrdiff_t>(at_ > 0 ? at_ - 1 : 0);
        const auto line = 1 + std::count(file_.begin(), read, '\n');
        throw InputError(fmt::format("{}: {}", place(path_, static_cast<std::size_t>(line)), what));
    }

    std::string_view file_;
    const std::filesystem::path& path_;
    std::size_t at_ = 0;
    bool binary_ = false;
    std::string section_ = "MeshFormat";
};

}  // namespace

void require_plausible_msh(std::string_view bytes, const std::filesystem::path& path) {
    Walk(bytes, path).check();
}

}  // namespace controlspace
