#include "study/results.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <nlohmann/json.hpp>
#include <string_view>

#include "controlspace/error.h"
#include "io/text/output_file.h"
#include "study/pareto.h"
#include "study/row_json.h"
#include "study/settings.h"
#include "study/tables.h"

namespace controlspace {
namespace {

using Json = nlohmann::ordered_json;

/// File names and command lines need not be UTF-8; JSON must.
std::string dump(const Json& json, int indent) {
    return json.dump(indent, ' ', false, Json::error_handler_t::replace);
}

Json to_json(ValueType type, const SettingValue& value) {
    if (type == ValueType::whole_number) {
        return static_cast<std::int64_t>(std::get<double>(value));
    }
    return std::visit([](const auto& v) { return Json(v); }, value);
}

template <class Target>
void add_settings(Json& json, std::span<const Setting<Target>> settings, const Target& target) {
    for (const Setting<Target>& setting : settings) {
        if (!setting.same_as.empty()) continue;
        const SettingValues values = setting.get(target);
        Json list = Json::array();
        for (const SettingValue& value : values) list.push_back(to_json(setting.type, value));
        const bool single = setting.at_most == 1;
        json[std::string(setting.key)] = !single          ? list
                                         : values.empty() ? Json(nullptr)
                                                          : list.front();
    }
}

Json settings_json(const Study& study) {
    Json json = Json::object();
    add_settings(json, study_settings(), study);
    json["runs"] = Json::array();
    for (const Run& run : study.runs) {
        Json run_json = Json::object();
        add_settings(run_json, run_settings(), run);
        json["runs"].push_back(std::move(run_json));
    }
    return json;
}

/// One field of a CSV file, quoted where it has to be (RFC 4180).
std::string csv_field(const Json& value) {
    if (value.is_null()) return "";
    if (value.is_array()) {
        std::vector<std::string> items;
        for (const Json& item : value) items.push_back(dump(item, -1));
        return fmt::format("{}", fmt::join(items, " "));
    }
    if (!value.is_string()) return dump(value, -1);
    const auto& text = value.get_ref<const std::string&>();
    if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
    std::string quoted = "\"";
    for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
    return quoted + '"';
}

}  // namespace

std::string results_json(const Provenance& p, const Study& study, std::span<const Row> rows,
                         bool complete) {
    Json json;
    json["schema_version"] = results_schema_version;
    json["program"] = "controlspace";
    json["version"] = p.version;
    json["commit"] = p.commit;
    json["dirty"] = p.dirty;
    json["compiler"] = p.compiler;
    json["flags"] = p.flags;
    json["cpu"] = p.cpu;
    json["cores"] = p.cores;
    json["threads"] = p.threads;
    json["seed"] = study.seed;
    json["date"] = p.date;
    json["command_line"] = p.command_line;
    json["settings"] = settings_json(study);
    json["complete"] = complete;
    json["rows"] = Json::array();
    for (const Row& row : rows) json["rows"].push_back(to_json(row));
    return dump(json, 1) + "\n";
}

std::string results_csv(std::span<const Row> rows) {
    std::string text;
    const auto add_line = [&](const Json& json, auto&& field) {
        for (const auto& [key, value] : json.items()) text += field(key, value) + ',';
        text.back() = '\n';
    };
    // Every row has the same fields, an empty one too.
    add_line(to_json(Row{}), [](const std::string& key, const Json&) { return key; });
    for (const Row& row : rows) {
        add_line(to_json(row),
                 [](const std::string&, const Json& value) { return csv_field(value); });
    }
    return text;
}

std::string results_summary(const Provenance& p, const Study& study, std::span<const Row> rows,
                            bool complete) {
    std::string text = fmt::format(
        "# {}\n\ncontrolspace {}, {}, {} ({} cores, {} threads), {}.\n\nSources: {}. Seed {}.\n\n"
        "`{}`\n\n",
        study.name, version_text(p), p.compiler, p.cpu, p.cores, p.threads, p.date,
        sources_name(study.sources), study.seed, p.command_line);
    if (!complete) text += "Not complete: cases are missing.\n\n";
    return text + render_tables(rows, TableStyle::markdown);
}

std::string origin_text(const Provenance& p, bool complete) {
    return fmt::format("controlspace {}, {}, {}{}: `{}`", version_text(p), p.cpu, p.date,
                       complete ? "" : ", not complete", p.command_line);
}

void make_results_folder(const std::filesystem::path& folder, std::string_view file) {
    std::error_code error;
    std::filesystem::create_directories(folder, error);
    if (error || !std::filesystem::is_directory(folder)) {
        throw InputError(fmt::format("{}: cannot be made ({}): choose another output folder",
                                     folder.string(), error ? error.message() : "it is a file"));
    }
    if (std::filesystem::exists(folder / file, error)) {
        throw InputError(fmt::format("{}: holds results already: choose another output folder",
                                     folder.string()));
    }
}

void replace_file(const std::filesystem::path& path, std::string_view text) {
    OutputFile file(path);
    file.write(text);
    file.commit();
}

ResultsFolder::ResultsFolder(std::filesystem::path folder) : folder_(std::move(folder)) {
    make_results_folder(folder_, "results.json");
}

ResultsFolder ResultsFolder::existing(std::filesystem::path folder) {
    ResultsFolder results;
    results.folder_ = std::move(folder);
    return results;
}

void ResultsFolder::write(const Provenance& provenance, const Study& study,
                          std::span<const Row> rows, bool complete) const {
    replace_file(folder_ / "results.json", results_json(provenance, study, rows, complete));
    replace_file(folder_ / "results.csv", results_csv(rows));
    replace_file(folder_ / "summary.md", results_summary(provenance, study, rows, complete));
    replace_file(folder_ / "pareto.json", pareto_json(rows));
}

std::filesystem::path results_path(const Study& study, const Provenance& provenance) {
    if (!study.output.empty()) return study.output;
    std::string stamp;  // 2024-05-01T12:00:00Z -> 20240501-120000
    for (const char c : provenance.date) {
        if (c == 'T') stamp += '-';
        if (c >= '0' && c <= '9') stamp += c;
    }
    return std::filesystem::path("results") / (study.name + "-" + stamp);
}

}  // namespace controlspace
