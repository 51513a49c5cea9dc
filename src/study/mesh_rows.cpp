// SPDX-License-Identifier: Apache-2.0
#include "study/mesh_rows.h"

#include <fmt/format.h>

#include <functional>

#include "controlspace/study/measure.h"
#include "study/grouped.h"
#include "study/results_json.h"
#include "study/tables.h"

namespace controlspace {
namespace {

using Rows = std::vector<const MeshRow*>;

/// The mesh of the exact field that `row` is to be compared with.
const MeshRow* exact_beside(const MeshRow& row, std::span<const MeshRow> rows) {
    const MeshRow* found = nullptr;
    for (const MeshRow& other : rows) {
        if (other.exact && other.error.empty() && other.mesher == row.mesher &&
            other.setting.sources == row.setting.sources && other.setting.g_r == row.setting.g_r &&
            other.setting.reference == row.setting.reference) {
            found = &other;
        }
    }
    return found;
}

std::span<const MeasureOf<MeshRow>> mesh_measures() {
    using R = MeshRow;
    static const std::vector<MeasureOf<R>> all{
        row_of("tets", &R::conformity, &Conformity::tets, {"tets", "{}"}),
        row_of("nodes", &R::conformity, &Conformity::nodes, {"nodes", "{}"}),
        row_of("edges", &R::conformity, &Conformity::edges),
        row_of("creation_s", &R::creation_s, std::identity(), {}, "s"),
        row_of("mesh_s", &R::cost, &MeshCost::seconds, {"s", "{:.1f}"}, "s"),
        row_of("mesh_processor_s", &R::cost, &MeshCost::processor_seconds, {"CPU s", "{:.1f}"},
               "s"),
        row_of("peak_bytes", &R::cost, &MeshCost::peak_bytes, {"MB", "{:.0f}", 1e-6}, "byte"),
        row_of("L_R", &R::conformity, &Conformity::l_r, {"L_R", "{:.4f}"}),
        row_of("L_R_beside_exact", &R::beside_exact, std::identity(), {"-exact", "{:+.4f}"}),
        row_of("L_R_middle", &R::conformity, &Conformity::l_r_middle, {"middle", "{:.4f}"}),
        row_of("unit_share", &R::conformity, &Conformity::unit_share, {"unit", "{:.4f}"}),
        row_of("mean_length", &R::conformity, &Conformity::mean_length, {"length", "{:.3f}"}),
        row_of("quality_min", &R::conformity, &Conformity::quality_min, {"q min", "{:.3f}"}),
        row_of("quality_mean", &R::conformity, &Conformity::quality_mean, {"q mean", "{:.3f}"}),
        row_of("queries", &R::cost, &MeshCost::queries, {"queries", "{}"}),
        row_of("query_s", &R::cost, &MeshCost::query_seconds, {}, "s"),
        // Of the processors' time: on a shared machine the clock goes on while others run.
        row_of("", &R::cost,
               [](const MeshCost& cost) { return cost.query_seconds / cost.processor_seconds; },
               {"share", "{:.2f} %", 100}),
        row_of("delta_R_max", &R::delta_r, &Accuracy::max, {"δ_R max", "{:.3f}"}),
        row_of("delta_R_mean", &R::delta_r, &Accuracy::mean, {"δ_R mean", "{:.4f}"}),
        {"shortfall", "", &R::shortfall, {"remark", "{}"}},
    };
    return all;
}

TextTable table_of(const std::string& title, const Rows& rows) {
    return measure_table(
        "Meshes: " + title,
        "L_R: share of edges of metric length 0.8 to 1.25; middle: by the metric at their middle "
        "alone; -exact: less that of the mesh of the exact field; unit: share from 1/√2 to √2. "
        "q: quality in the metric. share: of the processors' time, in the queries of the field.",
        "field", mesh_measures(), rows, mesh_label,
        [](const MeasureOf<MeshRow>& measure, const MeshRow& row) { return measure.value(row); });
}

/// The rows, with what they are beside the meshes of the exact fields.
std::vector<MeshRow> compared(std::span<const MeshRow> rows) {
    std::vector<MeshRow> found(rows.begin(), rows.end());
    for (MeshRow& row : found) {
        if (const MeshRow* exact = exact_beside(row, rows)) {
            row.beside_exact = row.conformity.l_r - exact->conformity.l_r;
        }
    }
    return found;
}

Json json_of(const MeshRow& row) {
    Json json;
    const Case& c = row.setting;
    json["field"] = row.exact ? "exact" : c.structure;
    json["split"] = row.exact || !c.split ? "" : std::string(name_of(*c.split));
    json["label"] = mesh_label(row);
    json["setting"] = mesh_setting(row);
    if (row.saved.empty()) json["case"] = to_json(c, case_parameters());
    json["mesher"] = name_of(row.mesher);
    json["error"] = row.error;
    if (!row.error.empty()) return json;
    json["histogram"] = row.conformity.histogram;
    for (const MeasureOf<MeshRow>& measure : mesh_measures()) {
        const Json value = to_json(measure.value(row));
        if (measure.key.empty() || value.is_null() || value == "") continue;
        json[measure.key] = value;
    }
    return json;
}

}  // namespace

std::string mesh_label(const MeshRow& row) {
    return row.exact ? "exact" : structure_label(row.setting);
}

std::string mesh_setting(const MeshRow& row) {
    return row.saved.empty() ? setting_label(row.setting) : row.saved.string();
}

std::string mesh_tables(std::span<const MeshRow> rows) {
    std::vector<TextTable> tables;
    const std::vector<MeshRow> all = compared(rows);
    for (const auto& [title, members] :
         grouped(std::span<const MeshRow>(all), [](const MeshRow& row) {
             return fmt::format("{}, {}", name_of(row.mesher), mesh_setting(row));
         })) {
        tables.push_back(table_of(title, members));
    }
    return render(tables);
}

std::string mesh_json(const Provenance& provenance, const Study& study,
                      const MeshSettings& settings, std::span<const MeshRow> rows, bool complete) {
    Json json;
    json["origin"] = fmt::format("controlspace {}, {}, {}, {} ({} cores), {}",
                                 version_text(provenance), provenance.compiler, provenance.flags,
                                 provenance.cpu, provenance.cores, provenance.date);
    json["command_line"] = provenance.command_line;
    json["study"] = to_json(study);
    for (const Parameter<MeshSettings>& p : mesh_parameters()) {
        json["settings"][p.key] = to_string(p.access.get(settings));
    }
    json["length_bounds"] = length_bounds;
    json["complete"] = complete;
    json["rows"] = Json::array();
    for (const MeshRow& row : compared(rows)) json["rows"].push_back(json_of(row));
    return dump(json, 1) + "\n";
}

}  // namespace controlspace
