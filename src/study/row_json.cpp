#include "study/row_json.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <string>

#include "study/names.h"

namespace controlspace {
namespace {

using Json = nlohmann::ordered_json;

template <class T>
Json or_null(const std::optional<T>& value) {
    return value ? Json(*value) : Json(nullptr);
}

void add_setting(Json& json, const Case& c) {
    const bool sampled = is_sampled(c.sources);
    const auto if_sampled = [&](double x) { return sampled ? Json(x) : Json(nullptr); };
    json["structure"] = c.structure;
    json["split"] = c.split ? Json(name_of(*c.split)) : Json(nullptr);
    json["rho"] = if_sampled(c.sources.rho);
    json["tau"] = c.tau;
    json["epsilon"] = c.epsilon;
    json["g_r"] = c.g_r;
    json["s_a"] = if_sampled(c.sources.s_a);
    json["s_n"] = if_sampled(c.sources.s_n);
    json["max_depth"] = or_null(c.max_depth);
    json["law"] = name_of(c.law);
    json["schedule"] = name_of(c.schedule);
    json["reference"] = name_of(c.reference);
}

void add_footprint(Json& json, const Footprint& f) {
    json["elements"] = f.elements;
    json["leaves"] = f.leaves;
    json["control_nodes"] = f.control_nodes;
    json["depth"] = f.depth;
    json["bytes_total"] = f.bytes_total();
    json["bytes_payload"] = f.bytes_payload;
    json["bytes_topology"] = f.bytes_topology;
    json["bytes_auxiliary"] = f.bytes_auxiliary;
    json["bytes_published_accounting"] = or_null(f.bytes_published);
}

void add_access(Json& json, const std::string& key, const AccessTime& access) {
    json[key] = access.median_ns();
    json[key + "_q1"] = access.quartile_ns(1);
    json[key + "_q3"] = access.quartile_ns(3);
    json[key + "_samples"] = access.samples_ns;
}

void add_accuracy(Json& json, const std::string& key, const Accuracy& accuracy) {
    json[key + "_max"] = accuracy.max;
    json[key + "_mean"] = accuracy.mean;
    json[key + "_p95"] = accuracy.p95;
    json[key + "_p99"] = accuracy.p99;
}

void add_measures(Json& json, const Measures& m) {
    json["sources_inserted"] = m.sources_inserted;
    add_footprint(json, m.footprint);
    json["t_insert_s"] = m.insert_s;
    json["t_gradation_s"] = m.gradation_s;
    add_access(json, "t_access_ns_random", m.access_random);
    add_access(json, "t_access_ns_grid", m.access_grid);
    json["delta_S_max"] = m.source_accuracy;
    add_accuracy(json, "delta_R", m.accuracy);
    add_accuracy(json, "delta_R_fine", m.accuracy_fine);
    json["delta_metric_R_max"] = m.accuracy.riemannian_max;
    json["gradation_max_left"] = m.gradation.largest_ratio_left;
    json["gradation_operations"] = m.gradation.operations;
    // As text: JSON readers keep 53 bits of a number.
    json["checksum"] = fmt::format("{:016x}", m.access_random.checksum);
    json["remark"] = m.footprint.remark;
}

}  // namespace

Json to_json(const Row& row) {
    Json json;
    add_setting(json, row.setting);
    json["sources"] = row.sources;
    if (row.measures) {
        add_measures(json, *row.measures);
    } else {
        // The same fields, so that every row has all of them.
        Json none;
        Measures empty;
        empty.access_random.samples_ns = empty.access_grid.samples_ns = {0};
        add_measures(none, empty);
        for (const auto& [key, value] : none.items()) json[key] = nullptr;
    }
    json["error"] = row.error;
    return json;
}

}  // namespace controlspace
