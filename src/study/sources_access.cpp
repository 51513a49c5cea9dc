// SPDX-License-Identifier: Apache-2.0
#include "study/sources_access.h"

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "controlspace/fields/primitives.h"
#include "controlspace/study/sources_choice.h"
#include "files/text_file.h"
#include "refuse.h"

namespace controlspace {
namespace {

/// The command line separates sources and the numbers of primitives alike by commas.
std::vector<std::string> whole_sources(const Values& values) {
    const auto continues = [](const std::string& word) {
        double number = 0;
        const std::size_t equals = word.find('=');
        return parse_number(word, number) ||
               (equals != word.npos && equals > 0 &&
                std::all_of(word.begin(), word.begin() + static_cast<std::ptrdiff_t>(equals),
                            [](char c) { return (c >= 'a' && c <= 'z') || c == '_'; }));
    };
    std::vector<std::string> whole;
    for (const Value& value : values) {
        const std::string& word = value.text();
        if (!whole.empty() && is_primitive(whole.back()) && continues(word)) {
            whole.back().append(1, ',').append(word);
        } else {
            whole.push_back(word);
        }
    }
    return whole;
}

}  // namespace

Access<Study> sources_access() {
    Access<Study> access;
    access.type = ValueType::text;
    access.at_most = 0;
    access.set = [](Study& s, const Values& v) {
        std::vector<Primitive> primitives;
        std::vector<std::filesystem::path> files;
        std::optional<SourcesKind> kind;
        for (const std::string& what : whole_sources(v)) {
            if (what.empty()) {
                refuse("no name: give sphere, planes, none, the names of files or primitives");
            }
            if (is_primitive(what)) {
                primitives.push_back(parse_primitive(what));
                continue;
            }
            const auto word = from_name<SourcesKind>(what);
            if (kind || (word && !files.empty())) {
                refuse("{} is no file: give it alone, or only names of files",
                       kind ? name_of(*kind) : what);
            }
            kind = word;
            if (!word) files.emplace_back(what == "-" ? "/dev/stdin" : what);
        }
        s.sources.kind = kind.value_or(files.empty() ? SourcesKind::none : SourcesKind::file);
        s.sources.files = std::move(files);
        s.sources.primitives = std::move(primitives);
    };
    access.get = [](const Study& s) {
        const std::vector<std::string> names = source_names(s.sources);
        return Values(names.begin(), names.end());
    };
    return access;
}

}  // namespace controlspace
