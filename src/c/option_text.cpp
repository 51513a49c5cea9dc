// SPDX-License-Identifier: Apache-2.0
#include "c/option_text.h"

#include <algorithm>
#include <set>
#include <utility>

#include "controlspace/space/split_words.h"
#include "files/text_file.h"
#include "refuse.h"

namespace controlspace {

namespace {

constexpr std::pair<std::string_view, double SpaceOptions::*> numbers[] = {
    {"tau", &SpaceOptions::l_min},
    {"epsilon", &SpaceOptions::tolerance},
    {"finest_length", &SpaceOptions::finest_length},
    {"voxel", &SpaceOptions::voxel},
    {"h_max", &SpaceOptions::h_max},
    {"g_r", &SpaceOptions::ratio}};

constexpr std::pair<std::string_view, std::optional<int> SpaceOptions::*> counts[] = {
    {"kd_depth", &SpaceOptions::kd_depth}, {"octree_depth", &SpaceOptions::octree_depth}};

/// The value of the row named `name`; null where there is none.
template <class Rows>
auto find(const Rows& rows, std::string_view name) {
    const auto row = std::find_if(std::begin(rows), std::end(rows),
                                  [&](const auto& known) { return known.first == name; });
    return row == std::end(rows) ? nullptr : &row->second;
}

template <class Number>
Number number_from(std::string_view name, std::string_view text) {
    Number value{};
    if (!parse_number(text, value)) {
        refuse("option {} is {}: give a number", name, quote(text));
    }
    return value;
}

void set_option(SpaceOptions& options, std::string_view name, std::string_view value) {
    if (const auto* number = find(numbers, name)) {
        options.*(*number) = number_from<double>(name, value);
    } else if (const auto* count = find(counts, name)) {
        options.*(*count) = number_from<int>(name, value);
    } else if (name == "split") {
        const auto split = from_name<SplitRule>(value);
        if (!split) {
            refuse("there is no split {}: give s_L, s_G, s_Gx or s_M", quote(value));
        }
        options.split = *split;
    } else if (name == "takes_later_sources") {
        options.takes_later_sources = number_from<int>(name, value) != 0;
    } else if (name == "max_memory") {
        const auto gib = number_from<double>(name, value);
        if (!(gib > 0 && gib < 1e9)) {
            refuse("max_memory is {} GiB: give a value above 0", gib);
        }
        options.max_bytes = static_cast<std::size_t>(gib * (1 << 30));
    } else {
        refuse("there is no option {}: see controlspace.h", quote(name));
    }
}

}  // namespace

SpaceOptions options_from_text(const Box& domain, std::string_view text) {
    SpaceOptions options{.domain = domain};
    constexpr std::string_view blanks = " \t\n,";
    std::set<std::string_view> given;
    while (true) {
        const std::size_t begin = text.find_first_not_of(blanks);
        if (begin == std::string_view::npos) return options;
        const std::size_t end = std::min(text.find_first_of(blanks, begin), text.size());
        const std::string_view word = text.substr(begin, end - begin);
        const std::size_t sign = word.find('=');
        if (sign == std::string_view::npos) {
            refuse("option {} has no value: write name=value", quote(word));
        }
        const std::string_view name = word.substr(0, sign);
        if (!given.insert(name).second) {
            refuse("option {} is given twice: give it once", quote(name));
        }
        set_option(options, name, word.substr(sign + 1));
        text.remove_prefix(end);
    }
}

}  // namespace controlspace
