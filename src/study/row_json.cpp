#include "study/row_json.h"

#include <fmt/format.h>

#include <charconv>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>

#include "controlspace/error.h"
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
    json["sampling"] = sampled ? Json(name_of(c.sources.sampling)) : Json(nullptr);
    json["field"] = name_of(c.sources.field.kind);
    json["max_depth"] = or_null(c.max_depth);
    json["voxel"] = or_null(c.voxel);
    json["voxel_factor"] = or_null(c.voxel_factor);
    json["prune_delta"] = or_null(c.prune_delta);
    json["target_delta"] = or_null(c.target_delta);
    json["equal_delta"] = or_null(c.equal_delta);
    json["equal_memory"] = or_null(c.equal_memory);
    json["node_values"] = name_of(c.node_values);
    json["frozen"] = name_of(c.frozen);
    json["law"] = name_of(c.law);
    json["schedule"] = name_of(c.schedule);
    json["neighbourhood"] = name_of(c.neighbourhood);
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

void add_coarser(Json& json, const std::string& key, const Accuracy& accuracy) {
    json[key + "_max"] = accuracy.coarser_max;
    json[key + "_share"] = accuracy.coarser_share;
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
    add_coarser(json, "coarser", m.accuracy);
    add_coarser(json, "coarser_fine", m.accuracy_fine);
    json["gradation_max_left"] = m.gradation.largest_ratio_left;
    json["gradation_operations"] = m.gradation.operations;
    // As text: JSON readers keep 53 bits of a number.
    json["checksum"] = fmt::format("{:016x}", m.access_random.checksum);
    json["remark"] = m.footprint.remark;
}

template <class Enum>
Enum named(const Json& json, const char* key) {
    const std::string name = json.at(key);
    if (const auto e = from_name<Enum>(name)) return *e;
    throw InputError(fmt::format("unknown {} '{}'", key, name));
}

template <class T>
std::optional<T> optional_from(const Json& json, const char* key) {
    const Json& value = json.at(key);
    return value.is_null() ? std::nullopt : std::optional<T>(value.get<T>());
}
/// For fields that older results do not have.
template <class T>
std::optional<T> newer_from(const Json& json, const char* key) {
    return json.contains(key) ? optional_from<T>(json, key) : std::nullopt;
}

Case setting_from(const Json& json, const SourcesChoice& sources) {
    Case c;
    c.structure = json.at("structure");
    if (!json.at("split").is_null()) c.split = named<SplitRule>(json, "split");
    c.sources = sources;
    if (json.contains("field")) c.sources.field.kind = named<FieldKind>(json, "field");
    if (json.contains("sampling") && !json.at("sampling").is_null()) {
        c.sources.sampling = named<Sampling>(json, "sampling");
    }
    c.sources.rho = optional_from<double>(json, "rho").value_or(sources.rho);
    c.sources.s_a = optional_from<double>(json, "s_a").value_or(sources.s_a);
    c.sources.s_n = optional_from<double>(json, "s_n").value_or(sources.s_n);
    c.tau = json.at("tau");
    c.epsilon = json.at("epsilon");
    c.g_r = json.at("g_r");
    c.max_depth = optional_from<int>(json, "max_depth");
    c.voxel = newer_from<double>(json, "voxel");
    c.voxel_factor = newer_from<double>(json, "voxel_factor");
    c.prune_delta = newer_from<double>(json, "prune_delta");
    c.target_delta = newer_from<double>(json, "target_delta");
    c.equal_delta = newer_from<double>(json, "equal_delta");
    c.equal_memory = newer_from<double>(json, "equal_memory");
    if (json.contains("node_values")) c.node_values = named<NodeValues>(json, "node_values");
    if (json.contains("frozen")) c.frozen = named<Frozen>(json, "frozen");
    c.law = named<GradationLaw>(json, "law");
    c.schedule = named<GradationSchedule>(json, "schedule");
    if (json.contains("neighbourhood")) {
        c.neighbourhood = named<Neighbourhood>(json, "neighbourhood");
    }
    c.reference = named<ReferenceKind>(json, "reference");
    return c;
}

/// JSON has no infinity: an error that is infinite is written as null.
double error_from(const Json& json, const std::string& key) {
    const Json& value = json.at(key);
    return value.is_null() ? std::numeric_limits<double>::infinity() : value.get<double>();
}

Accuracy accuracy_from(const Json& json, const std::string& key) {
    Accuracy accuracy;
    accuracy.max = error_from(json, key + "_max");
    accuracy.mean = error_from(json, key + "_mean");
    accuracy.p95 = error_from(json, key + "_p95");
    accuracy.p99 = error_from(json, key + "_p99");
    return accuracy;
}

/// Not a number where the results are from before this was measured.
void read_coarser(Accuracy& accuracy, const Json& json, const std::string& key) {
    const bool measured = json.contains(key + "_share");
    const double unknown = std::numeric_limits<double>::quiet_NaN();
    accuracy.coarser_max = measured ? error_from(json, key + "_max") : unknown;
    accuracy.coarser_share = measured ? json.at(key + "_share").get<double>() : unknown;
}

std::uint64_t checksum_from(const std::string& text) {
    std::uint64_t value = 0;
    const char* end = text.data() + text.size();
    const auto read = std::from_chars(text.data(), end, value, 16);
    if (read.ec != std::errc() || read.ptr != end) {
        throw InputError(fmt::format("'{}' is no checksum", text));
    }
    return value;
}

AccessTime access_time_from(const Json& json, const char* key) {
    AccessTime time;
    json.at(key).get_to(time.samples_ns);
    if (time.samples_ns.empty()) throw InputError(fmt::format("no samples in {}", key));
    return time;
}

Measures measures_from(const Json& json) {
    Measures m;
    m.sources_inserted = json.at("sources_inserted");
    Footprint& f = m.footprint;
    f.elements = json.at("elements");
    f.leaves = json.at("leaves");
    f.control_nodes = json.at("control_nodes");
    f.depth = json.at("depth");
    f.bytes_payload = json.at("bytes_payload");
    f.bytes_topology = json.at("bytes_topology");
    f.bytes_auxiliary = json.at("bytes_auxiliary");
    f.bytes_published = optional_from<std::size_t>(json, "bytes_published_accounting");
    f.remark = json.at("remark");
    m.insert_s = json.at("t_insert_s");
    m.gradation_s = json.at("t_gradation_s");
    m.access_random = access_time_from(json, "t_access_ns_random_samples");
    m.access_random.checksum = checksum_from(json.at("checksum"));
    m.access_grid = access_time_from(json, "t_access_ns_grid_samples");
    m.source_accuracy = error_from(json, "delta_S_max");
    m.accuracy = accuracy_from(json, "delta_R");
    m.accuracy.riemannian_max = error_from(json, "delta_metric_R_max");
    m.accuracy_fine = accuracy_from(json, "delta_R_fine");
    read_coarser(m.accuracy, json, "coarser");
    read_coarser(m.accuracy_fine, json, "coarser_fine");
    m.gradation.largest_ratio_left = json.at("gradation_max_left");
    m.gradation.operations = json.at("gradation_operations");
    return m;
}

}  // namespace

Row row_from_json(const Json& json, const SourcesChoice& sources) {
    Row row;
    row.setting = setting_from(json, sources);
    row.sources = json.at("sources");
    row.error = json.at("error");
    if (row.error.empty()) row.measures = measures_from(json);
    return row;
}

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
