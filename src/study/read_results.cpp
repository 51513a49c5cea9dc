#include "study/read_results.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "controlspace/error.h"
#include "io/text/text_file.h"
#include "study/results.h"
#include "study/row_json.h"
#include "study/settings.h"

namespace controlspace {
namespace {

using Json = nlohmann::ordered_json;

SettingValues setting_values(const Json& json) {
    SettingValues values;
    const auto add = [&](const Json& item) {
        if (item.is_string()) {
            values.emplace_back(item.get<std::string>());
        } else {
            values.emplace_back(item.get<double>());
        }
    };
    if (!json.is_array()) {
        add(json);
        return values;
    }
    for (const Json& item : json) add(item);
    return values;
}

Study study_from(const Json& settings) {
    Study study;
    for (const Setting<Study>& setting : study_settings()) {
        const auto found = settings.find(setting.key);
        if (found == settings.end() || found->is_null() || found->empty()) continue;
        try {
            set_checked(setting, study, setting_values(*found));
        } catch (const std::exception& error) {
            throw InputError(fmt::format("settings, {}: {}", setting.key, error.what()));
        }
    }
    return study;
}

Provenance provenance_from(const Json& json) {
    Provenance p;
    p.version = json.at("version");
    p.commit = json.at("commit");
    p.dirty = json.at("dirty");
    p.compiler = json.at("compiler");
    p.flags = json.at("flags");
    p.cpu = json.at("cpu");
    p.cores = json.at("cores");
    p.threads = json.at("threads");
    p.date = json.at("date");
    p.command_line = json.at("command_line");
    return p;
}

StoredResults results_from(const Json& json) {
    if (!json.is_object() || !json.contains("program") || json["program"] != "controlspace") {
        throw InputError("not written by this program: give a folder of results");
    }
    if (json.at("schema_version") != results_schema_version) {
        throw InputError(fmt::format("schema version {} is not {}: run the study again",
                                     json.at("schema_version").dump(), results_schema_version));
    }
    StoredResults results{provenance_from(json),
                          study_from(json.at("settings")),
                          {},
                          json.at("complete").get<bool>()};
    if (!json.at("rows").is_array()) throw InputError("rows is no list of rows");
    for (const Json& row : json.at("rows")) {
        try {
            results.rows.push_back(row_from_json(row, results.study.sources));
        } catch (const std::exception& error) {
            throw InputError(fmt::format("row {}: {}", results.rows.size() + 1, error.what()));
        }
    }
    return results;
}

}  // namespace

StoredResults read_results(const std::filesystem::path& folder) {
    const auto file = folder / "results.json";
    const std::string text = read_text_file(file);
    try {
        return results_from(Json::parse(text));
    } catch (const std::exception& error) {
        throw InputError(fmt::format("{}: {}", file.string(), error.what()));
    }
}

}  // namespace controlspace
