#include "io/text/medit_blocks.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include "controlspace/error.h"

namespace controlspace {
namespace {

constexpr std::int32_t cookie = 1;
constexpr std::int32_t swapped_cookie = 1 << 24;
constexpr std::int64_t dimension_code = 3;
constexpr std::int64_t end_code = 54;

std::int64_t code_of(std::string_view keyword) {
    if (keyword == "Vertices") return 4;
    if (keyword == "Triangles") return 6;
    if (keyword == "Tetrahedra") return 8;
    return 62;  // SolAtVertices
}

std::int32_t first_word(std::string_view bytes) {
    std::int32_t word = 0;
    if (bytes.size() >= sizeof word) std::memcpy(&word, bytes.data(), sizeof word);
    return word;
}

}  // namespace

bool MeditBlocks::are_in(std::string_view bytes) {
    const std::int32_t word = first_word(bytes);
    return word == cookie || word == swapped_cookie;
}

MeditBlocks::MeditBlocks(std::string_view bytes, const std::filesystem::path& path)
    : bytes_(bytes),
      file_size_(bytes.size()),
      path_(path),
      swapped_(first_word(bytes) == swapped_cookie) {
    at_ = sizeof cookie;
    version_ = count("the version");
    if (version_ < 1 || version_ > 4) {
        fail(fmt::format("the version is {}: only 1 to 4 can be read", version_));
    }
}

template <class Number>
Number MeditBlocks::take(std::string_view what) {
    std::array<char, sizeof(Number)> raw;
    if (bytes_.size() - at_ < raw.size()) fail(fmt::format("the data end within {}", what));
    std::memcpy(raw.data(), bytes_.data() + at_, raw.size());
    if (swapped_) std::reverse(raw.begin(), raw.end());
    at_ += raw.size();
    Number number;
    std::memcpy(&number, raw.data(), raw.size());
    return number;
}

std::int64_t MeditBlocks::integer(bool wide, std::string_view what) {
    return wide ? take<std::int64_t>(what) : take<std::int32_t>(what);
}

void MeditBlocks::find(std::string_view keyword) {
    const char* file = bytes_.data();
    bool is_3d = false;
    while (at_ < file_size_) {
        bytes_ = {file, file_size_};
        const std::int64_t code = integer(false, "a keyword");
        const std::int64_t next = integer(version_ >= 3, "the place of the next keyword");
        const bool is_last = next == 0;
        if (!is_last && (next < 0 || static_cast<std::uint64_t>(next) < at_ ||
                         static_cast<std::uint64_t>(next) > file_size_)) {
            fail(fmt::format("the next keyword is said to be at byte {} of {}: is it cut off?",
                             next, file_size_));
        }
        if (!is_last) bytes_ = {file, static_cast<std::size_t>(next)};
        if (code == dimension_code) {
            const std::uint64_t dimension = count("Dimension");
            if (dimension != 3) {
                fail(fmt::format("Dimension is {}: only 3 can be read", dimension));
            }
            is_3d = true;
        }
        if (code == code_of(keyword)) {
            if (!is_3d) fail(fmt::format("no Dimension before {}: add it", keyword));
            return;
        }
        if (is_last || code == end_code) break;
        at_ = bytes_.size();
    }
    throw InputError(fmt::format("{} has no {}: give a file that has", path_.string(), keyword));
}

std::uint64_t MeditBlocks::count(std::string_view what) {
    const std::int64_t n = integer(false, what);
    if (n < 0) fail(fmt::format("{} is {}: give a count", what, n));
    return static_cast<std::uint64_t>(n);
}

std::size_t MeditBlocks::rows(std::string_view what, std::size_t reals, std::size_t integers) {
    const std::int64_t n = integer(version_ >= 4, what);
    if (n <= 0) fail(fmt::format("{} {}: nothing to read", what, n));
    const std::size_t row =
        reals * (version_ == 1 ? sizeof(float) : sizeof(double)) +
        integers * (version_ >= 4 ? sizeof(std::int64_t) : sizeof(std::int32_t));
    const std::size_t most = (bytes_.size() - at_) / row;
    if (static_cast<std::uint64_t>(n) > most) {
        fail(fmt::format("{} {}, but the file can hold {} there at most: is it cut off?", what, n,
                         most));
    }
    return static_cast<std::size_t>(n);
}

double MeditBlocks::number(std::string_view what, std::size_t index) {
    const double x = version_ == 1 ? static_cast<double>(take<float>(what)) : take<double>(what);
    if (!std::isfinite(x)) fail(fmt::format("{} {} has {}, not finite", what, index + 1, x));
    return x;
}

void MeditBlocks::skip_reference(std::string_view what, std::size_t) {
    integer(version_ >= 4, what);
}

std::uint64_t MeditBlocks::index_up_to(std::uint64_t most, std::string_view what,
                                       std::size_t index) {
    const std::int64_t n = integer(version_ >= 4, what);
    if (n < 1 || static_cast<std::uint64_t>(n) > most) {
        fail(fmt::format("{} {}: {} is not one of 1 to {}", what, index + 1, n, most));
    }
    return static_cast<std::uint64_t>(n);
}

void MeditBlocks::fail(const std::string& what) const {
    throw InputError(fmt::format("{}, byte {}: {}", path_.string(), at_, what));
}

}  // namespace controlspace
