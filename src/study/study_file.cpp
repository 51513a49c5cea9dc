// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <toml++/toml.h>

#include <algorithm>
#include <cctype>

#include "controlspace/error.h"
#include "controlspace/study/study.h"
#include "files/text_file.h"
#include "refuse.h"

namespace controlspace {
namespace {

[[noreturn]] void fail(const std::filesystem::path& place, const toml::source_region& source,
                       std::string what) {
    // The parser names a character that it did not expect, which may be the end of the line.
    std::ranges::replace_if(
        what, [](unsigned char c) { return std::iscntrl(c) != 0; }, ' ');
    refuse("{}:{}: {}", place.string(), source.begin.line, what);
}

/// The value in a line that is a text without quotes; empty where there is none.
std::string_view unquoted_text(std::string_view line) {
    char quote = 0;
    // In a line of an array's values alone there is no key.
    bool is_value = line.find('=') == line.npos;
    for (std::size_t i = 0; i < line.size(); ++i) {
        const char c = line[i];
        if (quote != 0) {
            if (c == quote) quote = 0;
        } else if (c == '"' || c == '\'') {
            quote = c;
            is_value = false;
        } else if (c == '#') {
            break;
        } else if (c == '=' || c == '[' || c == ',') {
            is_value = true;
        } else if (is_value && c != ' ' && c != '\t' && c != ']') {
            std::string_view text = line.substr(i, line.find_first_of(",]#\r", i) - i);
            text = text.substr(0, text.find_last_not_of(" \t") + 1);
            double number = 0;
            if (!parse_number(text, number) && text != "true" && text != "false") return text;
            is_value = false;
        }
    }
    return {};
}

[[noreturn]] void fail_parsing(std::string_view text, const std::filesystem::path& place,
                               const toml::parse_error& error) {
    const std::string_view what = error.description();
    const std::size_t line = error.source().begin.line;
    if (what.find("key") == what.npos && what.find("table") == what.npos && line > 0) {
        const auto lines = split(text, '\n');
        const std::string_view value =
            unquoted_text(lines[std::min<std::size_t>(line, lines.size()) - 1]);
        if (!value.empty()) {
            fail(place, error.source(),
                 fmt::format("{0} is neither a number nor true or false: quote it, '{0}'", value));
        }
    }
    fail(place, error.source(), std::string(what));
}

/// The keys and values of one table of the file.
class Section {
public:
    Section(const toml::table& table, const std::filesystem::path& place)
        : table_(table), place_(place) {}

    void apply(Study& study) const {
        for (const Parameter<Study>& p : study_parameters()) {
            if_given(p.key, [&](const Values& v) { set_checked(p.access, study, v); });
        }
    }

    void apply(std::span<const CaseParameter> parameters, Run& run) const {
        if_given(structures_key, [&](const Values& v) { run.set_structures(v); });
        for (const CaseParameter& p : parameters) {
            if_given(p.key, [&](const Values& v) {
                require_alone(parameters, p);
                run.set(p, v, parameters);
            });
        }
    }

    void require_known(const std::vector<std::string>& known) const {
        for (const auto& [key, node] : table_) {
            if (std::ranges::count(known, key.str()) > 0) continue;
            const std::string nearest = did_you_mean(key.str(), known);
            fail(place_, key.source(),
                 fmt::format("unknown key '{}'", key.str()) +
                     (nearest.empty() ? fmt::format(": known are {}", fmt::join(known, ", "))
                                      : nearest));
        }
    }

private:
    template <class Set>
    void if_given(const std::string& key, const Set& set) const {
        const toml::node* node = table_.get(key);
        if (node == nullptr) return;
        const Values given = values(*node);
        try {
            set(given);
        } catch (const InputError& error) {
            fail(place_, node->source(), fmt::format("{}: {}", key, error.what()));
        }
    }

    /// Of the keys that set one value in several forms only one may be given.
    void require_alone(std::span<const CaseParameter> parameters, const CaseParameter& one) const {
        if (one.same_as.empty()) return;
        for (const CaseParameter& other : parameters) {
            const bool related = other.key == one.same_as || other.same_as == one.same_as;
            if (related && other.key != one.key && table_.contains(other.key)) {
                refuse("{} is the same setting: give one of them", other.key);
            }
        }
    }

    Values values(const toml::node& node) const {
        Values values;
        const auto add = [&](const toml::node& item) {
            if (const auto* x = item.as_floating_point()) {
                values.emplace_back(x->get());
            } else if (const auto* n = item.as_integer()) {
                values.emplace_back(static_cast<double>(n->get()));
            } else if (const auto* s = item.as_string()) {
                values.emplace_back(s->get());
            } else if (const auto* b = item.as_boolean()) {
                values.emplace_back(b->get() ? "true" : "false");
            } else {
                fail(place_, item.source(),
                     "give numbers, texts, true or false, or an array of them");
            }
        };
        if (const toml::array* array = node.as_array()) {
            for (const toml::node& item : *array) add(item);
        } else {
            add(node);
        }
        return values;
    }

    const toml::table& table_;
    const std::filesystem::path& place_;
};

void read_runs(const toml::node& node, const std::filesystem::path& place,
               std::span<const CaseParameter> parameters, const std::vector<std::string>& keys,
               Study& study) {
    const toml::array* tables = node.as_array();
    if (tables == nullptr || tables->empty() || !tables->is_homogeneous<toml::table>()) {
        fail(place, node.source(), "runs: give tables [[runs]]");
    }
    const Run defaults = study.runs.front();
    study.runs.clear();
    for (const toml::node& table : *tables) {
        const Section section(*table.as_table(), place);
        section.require_known(keys);
        section.apply(parameters, study.runs.emplace_back(defaults));
    }
}

}  // namespace

Study parse_study(std::string_view text, const std::filesystem::path& place,
                  std::span<const CaseParameter> parameters) {
    toml::table table;
    try {
        table = toml::parse(text, place.string());
    } catch (const toml::parse_error& error) {
        fail_parsing(text, place, error);
    }
    std::vector<std::string> run_keys{structures_key};
    for (const CaseParameter& p : parameters) run_keys.push_back(p.key);
    std::vector<std::string> keys = run_keys;
    for (const Parameter<Study>& p : study_parameters()) keys.push_back(p.key);
    keys.emplace_back("runs");

    Study study;
    study.name = place.stem().string();
    const Section top(table, place);
    top.require_known(keys);
    top.apply(study);
    top.apply(parameters, study.runs.front());
    if (const toml::node* runs = table.get("runs")) {
        read_runs(*runs, place, parameters, run_keys, study);
    }
    for (auto& file : study.sources.files) file = place.parent_path() / file;
    for (Primitive& primitive : study.sources.primitives) {
        if (primitive.shape == Shape::surface) {
            primitive.file = place.parent_path() / primitive.file;
        }
    }
    std::filesystem::path& field_file = study.sources.field.file;
    if (!field_file.empty()) field_file = place.parent_path() / field_file;
    return study;
}

Study read_study(const std::filesystem::path& file, std::span<const CaseParameter> parameters) {
    return parse_study(read_text_file(file), file, parameters);
}

}  // namespace controlspace
