// SPDX-License-Identifier: Apache-2.0
#include "io/text/medit_file.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "files/text_file.h"
#include "refuse.h"

namespace controlspace {
namespace {

constexpr std::int32_t cookie = 1, swapped_cookie = 1 << 24;
constexpr MeditKeyword dimension_word{"Dimension", 3}, end{"End", 54};

std::int32_t first_word(std::string_view bytes) {
    std::int32_t word = 0;
    if (bytes.size() >= sizeof word) std::memcpy(&word, bytes.data(), sizeof word);
    return word;
}

bool is_binary(std::string_view bytes) {
    const std::int32_t word = first_word(bytes);
    return word == cookie || word == swapped_cookie;
}

/// In capital letters or not: without a copy, as all words of a file are compared.
bool are_same_words(std::string_view a, std::string_view b) {
    const auto small = [](char c) { return c >= 'A' && c <= 'Z' ? char(c + 'a' - 'A') : c; };
    return a.size() == b.size() && std::ranges::equal(a, b, {}, small, small);
}

}  // namespace

MeditReader::MeditReader(std::string_view bytes, const std::filesystem::path& path)
    : bytes_(is_binary(bytes) ? bytes : text_in(bytes, path)), data_(bytes_, path, "#") {
    if (is_binary(bytes)) {
        data_.set_binary(true, first_word(bytes) == swapped_cookie);
        data_.number<std::int32_t>("the cookie");
        next_ = 2 * sizeof cookie;
    } else if (!are_same_words(data_.word(), "MeshVersionFormatted")) {
        fail("does not start with MeshVersionFormatted: give a Medit file");
    }
    version_ = integer(false, "the version");
    // BAMG writes version 0, in text alone.
    if (version_ < (data_.is_binary() ? 1 : 0) || version_ > 4) {
        fail("the version is {}: only 1 to 4 can be read", version_);
    }
}

bool MeditReader::next_block() {
    if (!data_.is_binary()) {
        word_ = data_.word();
        return !word_.empty() && !is_at(end);
    }
    if (next_ == 0 || next_ >= bytes_.size()) return false;
    data_.go_to(next_);
    data_.set_end(bytes_.size());
    code_ = integer(false, "a keyword");
    const std::int64_t next = integer(version_ >= 3, "the place of the next keyword");
    if (next != 0 && (next < 0 || static_cast<std::uint64_t>(next) < data_.at() ||
                      static_cast<std::uint64_t>(next) > bytes_.size())) {
        fail("the next keyword is said to be at byte {} of {}: is it cut off?", next,
             bytes_.size());
    }
    next_ = static_cast<std::size_t>(next);
    if (next_ != 0) data_.set_end(next_);
    return !is_at(end);
}

bool MeditReader::is_at(const MeditKeyword& keyword) const {
    return data_.is_binary() ? code_ == keyword.code : are_same_words(word_, keyword.word);
}

std::size_t MeditReader::find(const MeditKeyword& keyword, std::size_t reals,
                              std::size_t integers) {
    dimension_ = 0;
    while (next_block()) {
        if (is_at(dimension_word)) {
            const std::int64_t n = integer(false, "Dimension");
            if (n != 2 && n != 3) fail("Dimension is {}: only 2 and 3 can be read", n);
            dimension_ = static_cast<std::size_t>(n);
        }
        if (!is_at(keyword)) continue;
        if (dimension_ == 0) fail("no Dimension before {}: add 'Dimension 3'", keyword.word);
        const std::int64_t rows = integer(version_ >= 4, keyword.word);
        if (rows <= 0) fail("{} {}: nothing to read", keyword.word, rows);
        const std::size_t row_bytes =
            data_.is_binary() ? reals * (version_ == 1 ? sizeof(float) : sizeof(double)) +
                                    integers * (version_ >= 4 ? 8 : 4)
                              : 2 * (reals + integers);  // "0 0 0 ..."
        data_.require_room(keyword.word, static_cast<std::uint64_t>(rows), row_bytes);
        return static_cast<std::size_t>(rows);
    }
    refuse("{} has no {}: give a file that has", data_.path().string(), keyword.word);
}

void MeditReader::end_rows() {
    bool is_end = data_.rest().empty();
    if (!data_.is_binary()) {
        const std::string_view word = data_.word();
        is_end = word.empty() || word.find_first_of("0123456789+-.") != 0;
    } else if (!is_end && next_ == 0) {
        is_end = integer(false, "a keyword") == end.code;
    }
    if (is_end) return;
    fail("more numbers than the rows of Dimension {} have: is the Dimension or their count wrong?",
         dimension_);
}

std::int64_t MeditReader::integer(bool wide, const FilePart& part) {
    return wide || !data_.is_binary() ? data_.number<std::int64_t>(part)
                                      : data_.number<std::int32_t>(part);
}

double MeditReader::number(const FilePart& part) {
    const double x = data_.is_binary() && version_ == 1
                         ? static_cast<double>(data_.number<float>(part))
                         : data_.number<double>(part);
    if (!std::isfinite(x)) fail("{} has {}, not finite", part.text(), x);
    return x;
}

std::int64_t MeditReader::integer(const FilePart& part, std::int64_t most) {
    const std::int64_t n = integer(version_ >= 4, part);
    if (n < 1 || n > most) fail("{}: {} is not one of 1 to {}", part.text(), n, most);
    return n;
}

void MeditReader::skip_reference(const FilePart& part) {
    if (data_.is_binary()) {
        integer(version_ >= 4, part);
    } else {
        data_.number<double>(part);
    }
}

bool is_binary_medit_name(const std::filesystem::path& path) {
    const std::string name = path.string();
    return name.ends_with('b') || name.ends_with('B');
}

MeditWriter::MeditWriter(const std::filesystem::path& path, std::size_t data_bytes)
    : file_(path),
      binary_(is_binary_medit_name(path)),
      wide_(data_bytes + 128 > std::numeric_limits<std::int32_t>::max()) {
    if (!binary_) {
        file_.write("MeshVersionFormatted 2\n\nDimension 3\n");
        return;
    }
    file_.write_raw(cookie);
    file_.write_raw(std::int32_t{wide_ ? 3 : 2});
    size_ = 2 * sizeof cookie;
    begin_block(dimension_word.code, sizeof(std::int32_t));
    file_.write_raw(std::int32_t{3});
}

void MeditWriter::begin_block(std::int32_t code, std::size_t size) {
    size_ += sizeof code + (wide_ ? 8 : 4) + size;
    file_.write_raw(code);
    write_offset(size_);
}

void MeditWriter::write_offset(std::size_t offset) {
    if (wide_) {
        file_.write_raw(static_cast<std::int64_t>(offset));
    } else {
        file_.write_raw(static_cast<std::int32_t>(offset));
    }
}

void MeditWriter::begin(const MeditKeyword& keyword, std::size_t count, std::size_t row_bytes,
                        std::initializer_list<std::int32_t> head) {
    if (binary_) {
        begin_block(keyword.code, count * row_bytes + (1 + head.size()) * sizeof(std::int32_t));
        file_.write_raw(static_cast<std::int32_t>(count));
        return file_.write_raw(head.begin(), head.size());
    }
    file_.print("\n{}\n{}\n", keyword.word, count);
    for (const std::int32_t number : head) file_.print("{} ", number);
    if (head.size() > 0) file_.write("\n");
}

void MeditWriter::finish() {
    if (binary_) {
        file_.write_raw(end.code);
        write_offset(0);
    } else {
        file_.write("\nEnd\n");
    }
    file_.finish();
}

}  // namespace controlspace
