#pragma once

#include <cctype>
#include <string>
#include <string_view>
#include <vector>

namespace controlspace {

/// What is wrong with the nesting of elements in `page`, or nothing; as strict as XML is: every
/// element is closed, every attribute quoted, and < and & stand for themselves nowhere.
inline std::string markup_fault(std::string_view page) {
    std::vector<std::string> open;
    std::size_t at = 0;
    constexpr std::string_view doctype = "<!DOCTYPE html>";
    if (page.starts_with(doctype)) at = doctype.size();
    while (at < page.size()) {
        if (page[at] == '&') {
            const auto end = page.substr(at, 8).find(';');
            if (end == std::string_view::npos) return "a bare ampersand";
        }
        if (page[at] != '<') {
            ++at;
            continue;
        }
        std::size_t end = at + 1;
        for (bool quoted = false; end < page.size() && (quoted || page[end] != '>'); ++end) {
            if (page[end] == '"') quoted = !quoted;
            if (page[end] == '<') return "< within a tag";
        }
        if (end == page.size()) return "a tag without end";
        const std::string_view tag = page.substr(at + 1, end - at - 1);
        const bool closes = tag.starts_with('/');
        std::string name;
        for (const char c : tag.substr(closes ? 1 : 0)) {
            if (std::isalnum(static_cast<unsigned char>(c)) == 0) break;
            name += c;
        }
        if (name.empty()) return "a tag without name";
        if (closes) {
            if (open.empty() || open.back() != name) return "</" + name + "> closes nothing";
            open.pop_back();
        } else if (!tag.ends_with('/')) {
            open.push_back(name);
        }
        at = end + 1;
    }
    return open.empty() ? "" : "<" + open.back() + "> is not closed";
}

}  // namespace controlspace
