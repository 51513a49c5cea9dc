#include "c/option_text.h"

#include <fmt/format.h>

#include <algorithm>

#include "controlspace/error.h"
#include "io/text/text_file.h"
#include "study/names.h"

namespace controlspace {

namespace {

template <class Number>
Number number_from(std::string_view name, std::string_view text) {
    Number value{};
    if (!parse_number(text, value)) {
        throw InputError(fmt::format("option {} is {}: give a number", name, quote(text)));
    }
    return value;
}

void set_option(SpaceOptions& options, std::string_view name, std::string_view value) {
    const auto number = [&] { return number_from<double>(name, value); };
    const auto count = [&] { return number_from<int>(name, value); };
    if (name == "split") {
        const auto split = from_name<SplitRule>(value);
        if (!split)
            throw InputError(
                fmt::format("there is no split {}: give s_L, s_G, s_Gx or s_M", quote(value)));
        options.split = *split;
    } else if (name == "tau") {
        options.l_min = number();
    } else if (name == "epsilon") {
        options.tolerance = number();
    } else if (name == "kd_depth") {
        options.kd_depth = count();
    } else if (name == "octree_depth") {
        options.octree_depth = count();
    } else if (name == "finest_length") {
        options.finest_length = number();
    } else if (name == "voxel") {
        options.voxel = number();
    } else if (name == "g_r") {
        options.ratio = number();
    } else if (name == "takes_later_sources") {
        options.takes_later_sources = count() != 0;
    } else if (name == "max_memory") {
        const double gib = number();
        if (!(gib > 0 && gib < 1e9)) {
            throw InputError(fmt::format("max_memory is {} GiB: give a value above 0", gib));
        }
        options.max_bytes = static_cast<std::size_t>(gib * (1 << 30));
    } else {
        throw InputError(fmt::format("there is no option {}: see controlspace.h", quote(name)));
    }
}

}  // namespace

SpaceOptions options_from_text(const Box& domain, std::string_view text) {
    SpaceOptions options{.domain = domain};
    constexpr std::string_view blanks = " \t\n,";
    while (true) {
        const std::size_t begin = text.find_first_not_of(blanks);
        if (begin == std::string_view::npos) return options;
        const std::size_t end = std::min(text.find_first_of(blanks, begin), text.size());
        const std::string_view word = text.substr(begin, end - begin);
        const std::size_t sign = word.find('=');
        if (sign == std::string_view::npos) {
            throw InputError(fmt::format("option {} has no value: write name=value", quote(word)));
        }
        set_option(options, word.substr(0, sign), word.substr(sign + 1));
        text.remove_prefix(end);
    }
}

}  // namespace controlspace
