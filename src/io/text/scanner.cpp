// SPDX-License-Identifier: Apache-2.0
#include "io/text/scanner.h"

#include <fmt/format.h>

namespace controlspace {

void Scanner::skip_blanks() {
    while (true) {
        at_ = std::min(bytes_.find_first_not_of(blanks, at_), bytes_.size());
        if (!line_comment_.empty() && rest().starts_with(line_comment_)) {
            at_ = std::min(bytes_.find('\n', at_), bytes_.size());
        } else if (line_comment_ == "//" && rest().starts_with("/*")) {
            const std::size_t end = bytes_.find("*/", at_ + 2);
            at_ = end == std::string_view::npos ? bytes_.size() : end + 2;
        } else {
            break;
        }
    }
    token_ = at_;
}

std::string_view Scanner::word(std::string_view separators) {
    skip_blanks();
    at_ = std::min(bytes_.find_first_of(separators, at_), bytes_.size());
    return bytes_.substr(token_, at_ - token_);
}

std::string_view Scanner::line() {
    token_ = at_;
    const std::size_t end = std::min(bytes_.find('\n', at_), bytes_.size());
    at_ = std::min(end + 1, bytes_.size());
    return bytes_.substr(token_, end - token_);
}

bool Scanner::accept(std::string_view what) {
    skip_blanks();
    if (!rest().starts_with(what)) return false;
    at_ += what.size();
    return true;
}

void Scanner::expect(std::string_view what) {
    if (accept(what)) return;
    const std::string_view found = rest().substr(0, 12);
    fail("'{}' expected, {} found", what, found.empty() ? "the end of the file" : quote(found));
}

void Scanner::require_room(std::string_view what, std::uint64_t count, std::size_t bytes) const {
    const std::size_t most = rest().size() / bytes;
    if (count <= most) return;
    fail("{} {}, but the file can hold {} there at most: is it cut off?", what, count, most);
}

std::string Scanner::where() const {
    if (binary_) return fmt::format("{}, byte {}", path_.string(), at_);
    const auto before = bytes_.substr(0, token_);
    return place(path_,
                 1 + static_cast<std::size_t>(std::count(before.begin(), before.end(), '\n')));
}

std::string FilePart::text() const {
    return row ? fmt::format("{} {}", name, *row + 1) : std::string(name);
}

void Scanner::fail_end_within(const FilePart& part) const {
    fail("the data end within {}: is it cut off?", part.text());
}

void Scanner::fail_number(const FilePart& part, std::string_view word, bool is_integral) const {
    if (rest().empty() && word.empty()) fail_end_within(part);
    fail("{}: {} {}", part.text(), quote(word),
         is_integral ? "instead of a count" : "is not a number");
}

}  // namespace controlspace
