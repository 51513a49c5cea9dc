#include "study/sources_access.h"

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "controlspace/error.h"
#include "controlspace/fields/primitives.h"
#include "controlspace/study/sources_choice.h"
#include "files/text_file.h"

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
    constexpr std::pair<const char*, SourcesKind> words[] = {{"sphere", SourcesKind::sphere},
                                                             {"planes", SourcesKind::planes},
                                                             {"none", SourcesKind::none}};
    Access<Study> access;
    access.type = ValueType::text;
    access.at_most = 0;
    access.set = [words](Study& s, const Values& v) {
        const auto word_of = [](const auto& word) { return std::string_view(word.first); };
        std::vector<Primitive> primitives;
        std::vector<std::filesystem::path> files;
        const SourcesKind* kind = nullptr;
        std::string other;
        for (const std::string& what : whole_sources(v)) {
            if (what.empty()) {
                throw InputError(
                    "no name: give sphere, planes, none, the names of files or primitives");
            }
            if (is_primitive(what)) {
                primitives.push_back(parse_primitive(what));
                continue;
            }
            if (!other.empty() &&
                (kind != nullptr || std::ranges::count(words, what, word_of) > 0)) {
                throw InputError((kind != nullptr ? other : what) +
                                 " is no file: give it alone, or only names of files");
            }
            other = what;
            const auto* word = std::ranges::find(words, what, word_of);
            if (word != std::end(words)) {
                kind = &word->second;
            } else {
                files.emplace_back(what == "-" ? "/dev/stdin" : what);
            }
        }
        s.sources.kind = kind != nullptr ? *kind
                         : files.empty() ? SourcesKind::none
                                         : SourcesKind::file;
        s.sources.file = files.empty() ? std::filesystem::path() : files.front();
        if (!files.empty()) files.erase(files.begin());
        s.sources.further_files = std::move(files);
        s.sources.primitives = std::move(primitives);
    };
    access.get = [](const Study& s) {
        Values names;
        for (const std::string& name : source_names(s.sources)) names.emplace_back(name);
        return names;
    };
    return access;
}

}  // namespace controlspace
