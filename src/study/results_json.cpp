// SPDX-License-Identifier: Apache-2.0
#include "study/results_json.h"

#include <utility>

#include "controlspace/error.h"
#include "controlspace/study/results.h"
#include "refuse.h"

namespace controlspace {
namespace {

Json to_json(ValueType type, const Value& value) {
    if (type == ValueType::whole_number) return static_cast<std::int64_t>(value.number());
    if (type == ValueType::flag) return value.text() == "true";
    return std::visit([](const auto& v) { return Json(v); }, value);
}

MeasuredValue measured_from(const Json& json) {
    if (json.is_null()) return {};
    if (json.is_number_integer()) return json.get<std::int64_t>();
    if (json.is_number()) return json.get<double>();
    if (json.is_array()) return json.get<std::vector<double>>();
    return json.get<std::string>();
}

Json list_of(ValueType type, const Values& values) {
    Json list = Json::array();
    for (const Value& value : values) list.push_back(to_json(type, value));
    return list;
}

Values values_from(const Json& json) {
    Values values;
    const auto add = [&](const Json& item) {
        if (item.is_string()) {
            values.emplace_back(item.get<std::string>());
        } else if (item.is_boolean()) {
            values.emplace_back(item.get<bool>() ? "true" : "false");
        } else {
            values.emplace_back(item.get<double>());
        }
    };
    if (json.is_array()) {
        for (const Json& item : json) add(item);
    } else {
        add(json);
    }
    return values;
}

const std::string& result_key(const CaseParameter& parameter) {
    return parameter.result_key.empty() ? parameter.key : parameter.result_key;
}

/// The members of FieldFiles that name files, by their keys.
constexpr std::pair<const char*, std::string FieldFiles::*> field_files[] = {
    {"slice", &FieldFiles::slice},
    {"probes", &FieldFiles::probes},
    {"outlines", &FieldFiles::outlines},
    {"exact_slice", &FieldFiles::exact_slice},
    {"exact_probes", &FieldFiles::exact_probes}};

Json to_json(const std::optional<FieldFiles>& fields) {
    if (!fields) return nullptr;
    const Point &a = fields->domain.low, &b = fields->domain.high;
    Json json;
    json["domain"] = {a.x(), b.x(), a.y(), b.y(), a.z(), b.z()};
    json["z"] = fields->z;
    for (const auto& [key, file] : field_files) {
        const std::string& name = *fields.*file;
        json[key] = name.empty() ? Json(nullptr) : Json(name);
    }
    return json;
}

std::optional<FieldFiles> fields_from(const Json& json) {
    if (json.is_null()) return std::nullopt;
    FieldFiles fields;
    const auto x = json.at("domain").get<std::array<double, 6>>();
    fields.domain = {{x[0], x[2], x[4]}, {x[1], x[3], x[5]}};
    fields.z = json.at("z");
    for (const auto& [key, file] : field_files) {
        if (!json.at(key).is_null()) fields.*file = json.at(key);
    }
    return fields;
}

/// The texts of a Provenance, by their keys.
constexpr std::pair<const char*, std::string Provenance::*> provenance_texts[] = {
    {"version", &Provenance::version},
    {"commit", &Provenance::commit},
    {"compiler", &Provenance::compiler},
    {"flags", &Provenance::flags},
    {"cpu", &Provenance::cpu},
    {"date", &Provenance::date},
    {"command_line", &Provenance::command_line}};

/// Of what stands in labels and remarks: structures, settings, and the words of these.
Json descriptions(const StudyRows& rows) {
    Json json = {{"structures", Json::object()}, {"settings", Json::object()}};
    for (const CatalogueEntry& entry : rows.structures) {
        json["structures"][entry.id] = entry.description;
    }
    for (const CaseParameter& p : rows.parameters) {
        std::string text = p.help;
        if (!p.unit.empty()) text.append(" [").append(p.unit).append("]");
        for (const Choice& choice : p.access.choices) {
            text.append("; ").append(choice.name).append(": ").append(choice.meaning);
        }
        json["settings"][p.key] = text;
    }
    return json;
}

}  // namespace

Json to_json(const MeasuredValue& value) {
    return std::visit(
        [](const auto& v) -> Json {
            if constexpr (std::same_as<std::decay_t<decltype(v)>, std::monostate>) {
                return nullptr;
            } else {
                return v;
            }
        },
        value);
}

Json to_json(const Case& setting, std::span<const CaseParameter> parameters) {
    Json json;
    json["structure"] = setting.structure;
    for (const CaseParameter& p : parameters) {
        const std::string& key = result_key(p);
        const Values values = values_of(p, setting);
        const bool is_written = json.contains(key) && !json[key].is_null();
        if (p.is_form() || is_written) continue;
        json[key] = values.empty() ? Json(nullptr) : to_json(p.access.type, values.front());
    }
    return json;
}

Json to_json(const Row& row, const StudyRows& rows) {
    Json json = to_json(row.setting, rows.parameters);
    json["sources"] = row.sources;
    for (const Measure& measure : rows.measures) {
        const auto found = row.values.find(measure.key);
        json[measure.key] = found == row.values.end() ? Json(nullptr) : to_json(found->second);
    }
    json["error"] = row.error;
    json["fields"] = to_json(row.fields);
    json["labels"] = {{"structure", structure_label(row.setting, rows.parameters)},
                      {"setting", setting_label(row.setting, rows.parameters)},
                      {"work", work_label(row.setting, rows.parameters)},
                      {"method", method_label(row.setting, rows.parameters)}};
    return json;
}

Row row_from_json(const Json& json, const StudyRows& rows, const SourcesChoice& sources) {
    Row row;
    row.setting.sources = sources;
    row.setting.structure = json.at("structure");
    const CatalogueEntry* entry = find_entry(rows.structures, row.setting.structure);
    for (const CaseParameter& p : rows.parameters) {
        // A setting that an earlier program did not have is left out.
        const auto found = json.find(result_key(p));
        if (p.is_form() || found == json.end() || found->is_null()) continue;
        // Two parameters may stand under one key, each for structures of its own.
        if (entry != nullptr && result_key(p) != p.key && p.fits && !p.fits(*entry, row.setting)) {
            continue;
        }
        try {
            set_checked(p.access, row.setting, values_from(*found));
        } catch (const InputError& error) {
            refuse("{}: {}", result_key(p), error.what());
        }
    }
    row.sources = json.at("sources");
    row.error = json.at("error");
    for (const Measure& measure : rows.measures) {
        if (measure.may_be_missing && !json.contains(measure.key)) continue;
        const Json& value = json.at(measure.key);
        if (row.is_measured()) row.values[measure.key] = measured_from(value);
    }
    row.fields = fields_from(json.at("fields"));
    return row;
}

Json to_json(const Study& study) {
    Json json;
    for (const Parameter<Study>& p : study_parameters()) {
        const Json list = list_of(p.access.type, p.access.get(study));
        const bool is_one = p.access.at_most == 1 || (p.access.at_most == 0 && list.size() == 1);
        json[p.key] = !is_one ? list : list.empty() ? Json(nullptr) : list[0];
    }
    return json;
}

Json head_json(const Provenance& provenance, const Study& study, const StudyRows& rows) {
    const std::span<const CaseParameter> parameters = rows.parameters;
    Json json;
    json["schema_version"] = results_schema_version;
    json["program"] = "controlspace";
    for (const auto& [key, text] : provenance_texts) json[key] = provenance.*text;
    json["dirty"] = provenance.dirty;
    json["cores"] = provenance.cores;
    json["threads"] = provenance.threads;
    json["seed"] = study.seed;
    Json& settings = json["settings"] = to_json(study);
    settings["runs"] = Json::array();
    for (const Run& run : study.runs) {
        Json& lists = settings["runs"].emplace_back();
        lists[structures_key] = list_of(ValueType::text, run.structures());
        for (const CaseParameter& p : parameters) {
            if (!p.is_form()) lists[p.key] = list_of(p.access.type, run.values(p));
        }
    }
    for (const CaseParameter& p : parameters) {
        if (p.defaults.empty()) continue;
        json["defaults"].emplace(result_key(p), to_json(p.access.type, p.defaults.front()));
    }
    json["descriptions"] = descriptions(rows);
    return json;
}

Provenance provenance_from_json(const Json& head) {
    Provenance p;
    for (const auto& [key, text] : provenance_texts) p.*text = head.at(key);
    p.dirty = head.at("dirty");
    p.cores = head.at("cores");
    p.threads = head.at("threads");
    return p;
}

Study study_from_json(const Json& head) {
    const Json& settings = head.at("settings");
    Study study;
    for (const Parameter<Study>& p : study_parameters()) {
        const auto found = settings.find(p.key);
        if (found == settings.end() || found->is_null() || found->empty()) continue;
        try {
            set_checked(p.access, study, values_from(*found));
        } catch (const std::exception& error) {
            refuse("settings, {}: {}", p.key, error.what());
        }
    }
    return study;
}

std::string dump(const Json& json, int indent) {
    return json.dump(indent, ' ', false, Json::error_handler_t::replace);
}

}  // namespace controlspace
