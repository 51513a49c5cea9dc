#include "study/study_file.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <toml++/toml.h>

#include <algorithm>

#include "controlspace/error.h"
#include "io/text/text_file.h"
#include "study/settings.h"

namespace controlspace {
namespace {

[[noreturn]] void fail(const std::filesystem::path& place, const toml::source_region& source,
                       std::string_view what) {
    throw InputError(fmt::format("{}:{}: {}", place.string(), source.begin.line, what));
}

/// The settings that stand in one table of the file.
class Section {
public:
    Section(const toml::table& table, const std::filesystem::path& place)
        : table_(table), place_(place) {}

    template <class Target>
    void apply(std::span<const Setting<Target>> settings, Target& target) const {
        for (const Setting<Target>& setting : settings) {
            const toml::node* node = table_.get(setting.key);
            if (node == nullptr) continue;
            if (!setting.same_as.empty()) require_alone(settings, setting, *node);
            const SettingValues given = values(*node);
            try {
                set_checked(setting, target, given);
            } catch (const InputError& error) {
                fail(place_, node->source(), fmt::format("{}: {}", setting.key, error.what()));
            }
        }
    }

    void require_known(const std::vector<std::string_view>& known) const {
        for (const auto& [key, node] : table_) {
            if (std::find(known.begin(), known.end(), key.str()) != known.end()) continue;
            fail(place_, key.source(),
                 fmt::format("unknown key '{}': known are {}", key.str(), fmt::join(known, ", ")));
        }
    }

private:
    /// Of the keys that set one value in several forms only one may be given.
    template <class Target>
    void require_alone(std::span<const Setting<Target>> settings, const Setting<Target>& setting,
                       const toml::node& node) const {
        for (const Setting<Target>& other : settings) {
            const bool related = other.key == setting.same_as || other.same_as == setting.same_as;
            if (related && other.key != setting.key && table_.contains(other.key)) {
                fail(place_, node.source(),
                     fmt::format("{} and {} say the same: give one", setting.key, other.key));
            }
        }
    }

    SettingValues values(const toml::node& node) const {
        SettingValues values;
        const auto add = [&](const toml::node& item) {
            if (const auto* x = item.as_floating_point()) {
                values.emplace_back(x->get());
            } else if (const auto* n = item.as_integer()) {
                values.emplace_back(static_cast<double>(n->get()));
            } else if (const auto* s = item.as_string()) {
                values.emplace_back(s->get());
            } else {
                fail(place_, item.source(), "give numbers, texts, or an array of them");
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

template <class Target>
void add_keys(std::vector<std::string_view>& keys, std::span<const Setting<Target>> settings) {
    for (const Setting<Target>& setting : settings) keys.push_back(setting.key);
}

void read_runs(const toml::node& node, const std::filesystem::path& place, Study& study) {
    const toml::array* tables = node.as_array();
    if (tables == nullptr || tables->empty() || !tables->is_homogeneous<toml::table>()) {
        fail(place, node.source(), "runs: give tables [[runs]]");
    }
    std::vector<std::string_view> keys;
    add_keys(keys, run_settings());
    const Run defaults = study.runs.front();
    study.runs.clear();
    for (const toml::node& table : *tables) {
        const Section section(*table.as_table(), place);
        section.require_known(keys);
        section.apply(run_settings(), study.runs.emplace_back(defaults));
    }
}

}  // namespace

Study parse_study(std::string_view text, const std::filesystem::path& place) {
    toml::table table;
    try {
        table = toml::parse(text, place.string());
    } catch (const toml::parse_error& error) {
        fail(place, error.source(), error.description());
    }
    Study study;
    study.name = place.stem().string();
    const Section top(table, place);
    std::vector<std::string_view> keys{"runs"};
    add_keys(keys, study_settings());
    add_keys(keys, run_settings());
    top.require_known(keys);
    top.apply(study_settings(), study);
    top.apply(run_settings(), study.runs.front());
    if (const toml::node* runs = table.get("runs")) read_runs(*runs, place, study);
    if (study.sources.kind == SourcesKind::file) {
        study.sources.file = place.parent_path() / study.sources.file;
    }
    std::filesystem::path& field_file = study.sources.field.file;
    if (!field_file.empty()) field_file = place.parent_path() / field_file;
    return study;
}

Study read_study(const std::filesystem::path& file) {
    return parse_study(read_text_file(file), file);
}

}  // namespace controlspace
