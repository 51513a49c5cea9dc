#include "study/mesh_rows.h"

#include <fmt/format.h>

#include <concepts>

#include "controlspace/study/measure.h"
#include "study/grouped.h"
#include "study/rank_correlation.h"
#include "study/results_json.h"
#include "study/tables.h"

namespace controlspace {
namespace {

using Rows = std::vector<const MeshRow*>;

/// What was meshed may be the reference: there is no δ_R of it then.
bool has_delta_r(const MeshRow& row) { return !row.exact && row.saved.empty(); }

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

/// A measure of meshes: in meshes.json where it has a key, in tables where it has a column.
struct MeshMeasure {
    std::string key;
    Column column;
    /// `exact`: the mesh of the exact field to compare with, or null.
    std::function<MeasuredValue(const MeshRow& row, const MeshRow* exact)> value;
};

/// A row of a number that `get` returns.
template <class Get>
MeshMeasure row(const char* key, const Column& column, Get get) {
    return {key, column, [get](const MeshRow& mesh, const MeshRow*) -> MeasuredValue {
                const auto number = get(mesh);
                if constexpr (std::integral<decltype(number)>) {
                    return static_cast<std::int64_t>(number);
                } else {
                    return number;
                }
            }};
}
/// A row of a number that meshes of the reference do not have.
template <class Get>
MeshMeasure compared(const char* key, const Column& column, Get get) {
    return row(key, column, [get](const MeshRow& mesh) {
        return has_delta_r(mesh) ? MeasuredValue(get(mesh)) : MeasuredValue();
    });
}

const std::vector<MeshMeasure>& mesh_measures() {
    using Row = const MeshRow&;
    static const std::vector<MeshMeasure> all{
        row("tets", {"tets", "{}"}, [](Row r) { return r.conformity.tets; }),
        row("nodes", {"nodes", "{}"}, [](Row r) { return r.conformity.nodes; }),
        row("edges", {}, [](Row r) { return r.conformity.edges; }),
        row("creation_s", {}, [](Row r) { return r.creation_s; }),
        row("mesh_s", {"s", "{:.1f}"}, [](Row r) { return r.cost.seconds; }),
        row("mesh_processor_s", {"CPU s", "{:.1f}"},
            [](Row r) { return r.cost.processor_seconds; }),
        row("peak_bytes", {"MB", "{:.0f}", 1e-6}, [](Row r) { return r.cost.peak_bytes; }),
        row("L_R", {"L_R", "{:.4f}"}, [](Row r) { return r.conformity.l_r; }),
        {"",
         {"-exact", "{:+.4f}"},
         [](Row r, const MeshRow* exact) {
             return exact != nullptr ? MeasuredValue(r.conformity.l_r - exact->conformity.l_r)
                                     : MeasuredValue();
         }},
        row("L_R_middle", {"middle", "{:.4f}"}, [](Row r) { return r.conformity.l_r_middle; }),
        row("unit_share", {"unit", "{:.4f}"}, [](Row r) { return r.conformity.unit_share; }),
        row("mean_length", {"length", "{:.3f}"}, [](Row r) { return r.conformity.mean_length; }),
        row("quality_min", {"q min", "{:.3f}"}, [](Row r) { return r.conformity.quality_min; }),
        row("quality_mean", {"q mean", "{:.3f}"}, [](Row r) { return r.conformity.quality_mean; }),
        row("queries", {"queries", "{}"}, [](Row r) { return r.cost.queries; }),
        row("query_s", {}, [](Row r) { return r.cost.query_seconds; }),
        // Of the processors' time: on a shared machine the clock goes on while others run.
        row("", {"share", "{:.2f} %", 100},
            [](Row r) { return r.cost.query_seconds / r.cost.processor_seconds; }),
        compared("delta_R_max", {"δ_R max", "{:.3f}"}, [](Row r) { return r.delta_r_max; }),
        compared("delta_R_mean", {"δ_R mean", "{:.4f}"}, [](Row r) { return r.delta_r_mean; }),
    };
    return all;
}

/// "Rank correlation of L_R with ...", or nothing where there are too few structures.
std::string correlation_text(const Rows& rows) {
    std::vector<double> l_r, largest, mean;
    for (const MeshRow* row : rows) {
        if (!has_delta_r(*row) || !row->error.empty()) continue;
        l_r.push_back(row->conformity.l_r);
        largest.push_back(row->delta_r_max);
        mean.push_back(row->delta_r_mean);
    }
    const auto with_largest = spearman(l_r, largest), with_mean = spearman(l_r, mean);
    if (!with_largest || !with_mean) return "";
    return fmt::format(
        " Rank correlation (Spearman) of L_R with the largest δ_R {:.2f}, with the mean one "
        "{:.2f}.",
        *with_largest, *with_mean);
}

TextTable measure_table(const std::string& title, const Rows& rows, std::span<const MeshRow> all) {
    TextTable table{
        "Meshes: " + title,
        "L_R: share of edges of metric length 0.8 to 1.25; middle: by the metric at their middle "
        "alone; -exact: less that of the mesh of the exact field; unit: share from 1/√2 to √2. "
        "q: quality in the metric. share: of the processors' time, in the queries of the field." +
            correlation_text(rows),
        {{"field", Align::left}},
        {}};
    for (const MeshMeasure& measure : mesh_measures()) {
        if (!measure.column.header.empty()) table.columns.push_back({measure.column.header});
    }
    table.columns.push_back({"remark", Align::left});
    for (const MeshRow* row : rows) {
        auto& cells = table.rows.emplace_back();
        cells.push_back(mesh_label(*row));
        for (const MeshMeasure& measure : mesh_measures()) {
            if (measure.column.header.empty()) continue;
            cells.push_back(cell_of(
                row->error.empty() ? measure.value(*row, exact_beside(*row, all)) : MeasuredValue(),
                measure.column));
        }
        cells.push_back(row->error.empty() ? row->shortfall : "failed: " + row->error);
    }
    return table;
}

TextTable histogram_table(const std::string& title, const Rows& rows) {
    TextTable table{"Edges by metric length [%]: " + title, "", {{"field", Align::left}}, {}};
    std::string from = "0";
    for (const double bound : length_bounds) {
        const std::string to = fmt::format("{:.3g}", bound);
        table.columns.push_back({from + "–" + to});
        from = to;
    }
    table.columns.push_back({from + "–"});
    for (const MeshRow* row : rows) {
        if (!row->error.empty()) continue;
        auto& cells = table.rows.emplace_back();
        cells.push_back(mesh_label(*row));
        for (const std::size_t count : row->conformity.histogram) {
            const double share =
                static_cast<double>(count) / static_cast<double>(row->conformity.edges);
            cells.push_back(fmt::format("{:.2f}", 100 * share));
        }
    }
    return table;
}

Json json_of(const MeshRow& row) {
    Json json;
    const Case& c = row.setting;
    json["field"] = row.exact ? "exact" : c.structure;
    json["split"] = row.exact || !c.split ? "" : std::string(name_of(*c.split));
    json["setting"] = mesh_setting(row);
    if (row.saved.empty()) json["case"] = to_json(c, case_parameters());
    json["mesher"] = name_of(row.mesher);
    json["error"] = row.error;
    if (!row.error.empty()) return json;
    if (!row.shortfall.empty()) json["shortfall"] = row.shortfall;
    json["histogram"] = row.conformity.histogram;
    for (const MeshMeasure& measure : mesh_measures()) {
        const MeasuredValue value = measure.value(row, nullptr);
        if (measure.key.empty() || std::holds_alternative<std::monostate>(value)) continue;
        json[measure.key] = to_json(value);
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

std::string mesh_tables(std::span<const MeshRow> rows, TableStyle style) {
    std::vector<TextTable> tables;
    for (const auto& [title, members] : grouped(rows, [](const MeshRow& row) {
             return fmt::format("{}, {}", name_of(row.mesher), mesh_setting(row));
         })) {
        tables.push_back(measure_table(title, members, rows));
        tables.push_back(histogram_table(title, members));
    }
    return render(tables, style);
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
    for (const MeshRow& row : rows) json["rows"].push_back(json_of(row));
    return dump(json, 1) + "\n";
}

}  // namespace controlspace
