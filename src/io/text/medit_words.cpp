#include "io/text/medit_words.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "controlspace/error.h"
#include "io/text/text_file.h"

namespace controlspace {
namespace {

bool is_blank(char c) { return c == ' ' || (c >= '\t' && c <= '\r'); }

}  // namespace

MeditWords::MeditWords(std::string_view text, const std::filesystem::path& path)
    : text_(text), path_(path) {
    if (word() != "MeshVersionFormatted") {
        fail("does not start with MeshVersionFormatted: give an ASCII Medit file");
    }
    const auto version = count("MeshVersionFormatted");
    if (version < 1 || version > 4) fail("MeshVersionFormatted must be 1 to 4");
}

std::string_view MeditWords::word() {
    while (at_ < text_.size()) {
        const char c = text_[at_];
        if (c == '#') {
            at_ = std::min(text_.find('\n', at_), text_.size());
        } else if (is_blank(c)) {
            line_ += c == '\n' ? 1 : 0;
            ++at_;
        } else {
            break;
        }
    }
    const std::size_t begin = at_;
    while (at_ < text_.size() && !is_blank(text_[at_])) ++at_;
    return text_.substr(begin, at_ - begin);
}

void MeditWords::find(std::string_view keyword) {
    bool is_3d = false;
    for (std::string_view w = word(); w != "End"; w = word()) {
        if (w.empty()) break;
        if (w == "Dimension") {
            const auto dimension = count("Dimension");
            if (dimension != 3) {
                fail(fmt::format("Dimension is {}: only 3 can be read", dimension));
            }
            is_3d = true;
        }
        if (w != keyword) continue;
        if (!is_3d) fail(fmt::format("no Dimension before {}: add 'Dimension 3'", keyword));
        return;
    }
    throw InputError(fmt::format("{} has no {}: give a file that has", path_.string(), keyword));
}

std::uint64_t MeditWords::count(std::string_view what) {
    const std::string_view w = word();
    std::uint64_t n = 0;
    if (!parse_number(w, n)) {
        fail(fmt::format("{} is followed by {} instead of a count", what, quote(w)));
    }
    return n;
}

std::size_t MeditWords::rows(std::string_view what, std::size_t reals, std::size_t integers) {
    const std::uint64_t n = count(what);
    if (n == 0) fail(fmt::format("{} 0: nothing to read", what));
    const std::size_t most = (text_.size() - at_) / (2 * (reals + integers));  // "0 0 0 ..."
    if (n > most) {
        fail(fmt::format("{} {}, but the rest of the file can hold {} at most: is it cut off?",
                         what, n, most));
    }
    return static_cast<std::size_t>(n);
}

double MeditWords::number(std::string_view what, std::size_t index) {
    const std::string_view w = row_word(what, index);
    double x = 0;
    if (!parse_number(w, x)) {
        fail(fmt::format("{} {}: {} is not a number", what, index + 1, quote(w)));
    }
    if (!std::isfinite(x)) fail(fmt::format("{} {} has {}, not finite", what, index + 1, x));
    return x;
}

std::uint64_t MeditWords::index_up_to(std::uint64_t most, std::string_view what,
                                      std::size_t index) {
    const std::string_view w = row_word(what, index);
    std::uint64_t n = 0;
    if (!parse_number(w, n) || n < 1 || n > most) {
        fail(fmt::format("{} {}: {} is not one of 1 to {}", what, index + 1, quote(w), most));
    }
    return n;
}

std::string_view MeditWords::row_word(std::string_view what, std::size_t index) {
    const std::string_view w = word();
    if (w.empty()) fail(fmt::format("the file ends within {} {}", what, index + 1));
    return w;
}

void MeditWords::fail(const std::string& what) const {
    throw InputError(fmt::format("{}: {}", place(path_, line_), what));
}

}  // namespace controlspace
