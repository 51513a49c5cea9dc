// SPDX-License-Identifier: Apache-2.0
#include "io/text/cad_unit.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <map>
#include <set>
#include <string_view>
#include <utility>

#include "controlspace/io/read_sources.h"
#include "files/text_file.h"

namespace controlspace {
namespace {

/// What stands between `open` and `close` behind the first `word` of an entity.
std::string_view behind(std::string_view entity, std::string_view word, char open, char close) {
    const std::size_t at = entity.find(word);
    if (at == std::string_view::npos) return {};
    const std::size_t begin = entity.find(open, at + word.size());
    if (begin == std::string_view::npos) return {};
    const std::size_t end = entity.find(close, begin + 1);
    if (end == std::string_view::npos) return {};
    return entity.substr(begin + 1, end - begin - 1);
}

/// Entities such as #1=(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.MILLI.,.METRE.)); units like the inch
/// name one of these, which then does not count.
std::set<std::string> step_units(std::string_view text) {
    static const std::map<std::string_view, std::string_view> prefixes{
        {"$", "m"},        {".NANO.", "nm"}, {".MICRO.", "um"}, {".MILLI.", "mm"},
        {".CENTI.", "cm"}, {".DECI.", "dm"}, {".KILO.", "km"}};
    std::set<std::string> metric, others;
    for (std::size_t at = 0; (at = text.find("LENGTH_UNIT", at)) != std::string_view::npos; ++at) {
        const std::size_t begin = text.rfind(';', at) + 1;
        const std::string_view entity = text.substr(begin, text.find(';', at) - begin);
        if (entity.find("CONVERSION_BASED_UNIT") != std::string_view::npos) {
            const std::string name =
                lower_case(std::string(behind(entity, "CONVERSION_BASED_UNIT", '\'', '\'')));
            others.insert(name.starts_with("inch") ? "in" : name == "foot" ? "ft" : name);
            continue;
        }
        std::string prefix(behind(entity, "SI_UNIT", '(', ','));
        std::erase_if(prefix, [](char c) { return c == ' ' || c == '\n' || c == '\r'; });
        if (const auto known = prefixes.find(prefix); known != prefixes.end()) {
            metric.insert(std::string(known->second));
        }
    }
    return others.empty() ? metric : others;
}

/// The fourteenth parameter of the global section, whose lines have a G in column 73. Texts in it
/// are written with their length: 3Habc.
std::set<std::string> iges_units(std::string_view text) {
    constexpr std::size_t column = 72, unit_flag = 14;
    constexpr std::array<const char*, 12> names{"",  "in", "mm",  "",   "ft", "mi",
                                                "m", "km", "mil", "um", "cm", "uin"};
    std::string global;
    for (const std::string_view line : split(text, '\n')) {
        if (line.size() > column && line[column] == 'G') global += line.substr(0, column);
    }
    char separator = ',';
    std::size_t at = 0;
    for (std::size_t parameter = 1; at < global.size(); ++parameter) {
        at = std::min(global.find_first_not_of(' ', at), global.size());
        const std::size_t digits =
            std::min(global.find_first_not_of("0123456789", at), global.size());
        std::size_t length = 0;
        parse_number(std::string_view(global).substr(at, digits - at), length);
        if (parameter == unit_flag) {
            return length > 0 && length < names.size() && *names[length] != 0
                       ? std::set<std::string>{names[length]}
                       : std::set<std::string>{};
        }
        if (digits > at && digits < global.size() && global[digits] == 'H') {
            if (parameter == 1 && length == 1) separator = global[digits + 1];
            at = std::min(digits + 1 + length, global.size());
        }
        at = std::min(global.find(separator, at), global.size()) + 1;
    }
    return {};
}

}  // namespace

std::string cad_unit(const std::filesystem::path& file) {
    const std::string ending = lower_case_extension(file);
    std::set<std::string> units;
    if (ending == ".step" || ending == ".stp") units = step_units(read_binary_file(file));
    if (ending == ".iges" || ending == ".igs") units = iges_units(read_binary_file(file));
    return fmt::format("{}", fmt::join(units, " and "));
}

}  // namespace controlspace
