#include "mesh/mesh_rows.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

#include "study/names.h"
#include "study/rank_correlation.h"

namespace controlspace {
namespace {

using Rows = std::vector<const MeshRow*>;

constexpr double mb = 1e6;
constexpr std::string_view absent = "–";

/// Rows that were meshed alike, under one setting.
struct Group {
    std::string title;
    Rows rows;
};

/// What was meshed may be the reference: there is no δ_R of it then.
bool has_delta_r(const MeshRow& row) { return !row.exact && row.saved.empty(); }

std::vector<Group> groups_of(std::span<const MeshRow> rows) {
    std::vector<Group> groups;
    for (const MeshRow& row : rows) {
        const std::string title = fmt::format("{}, {}", name_of(row.mesher), mesh_setting(row));
        auto group = std::find_if(groups.begin(), groups.end(),
                                  [&](const Group& g) { return g.title == title; });
        if (group == groups.end()) group = groups.insert(groups.end(), {title, {}});
        group->rows.push_back(&row);
    }
    return groups;
}

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

/// Of the processors' time: on a shared machine the clock goes on while others run.
double query_share(const MeshRow& row) { return row.query_seconds / row.processor_seconds; }

std::vector<std::string> measure_cells(const MeshRow& row, const MeshRow* exact) {
    std::vector<std::string> cells{mesh_label(row)};
    if (!row.error.empty()) {
        cells.insert(cells.end(), 16, std::string(absent));
        cells.push_back("failed: " + row.error);
        return cells;
    }
    const Conformity& c = row.conformity;
    cells.push_back(fmt::format("{}", c.tets));
    cells.push_back(fmt::format("{}", c.nodes));
    cells.push_back(fmt::format("{:.1f}", row.seconds));
    cells.push_back(fmt::format("{:.1f}", row.processor_seconds));
    cells.push_back(fmt::format("{:.0f}", static_cast<double>(row.peak_bytes) / mb));
    cells.push_back(fmt::format("{:.4f}", c.l_r));
    cells.push_back(exact != nullptr ? fmt::format("{:+.4f}", c.l_r - exact->conformity.l_r)
                                     : std::string(absent));
    cells.push_back(fmt::format("{:.4f}", c.l_r_middle));
    cells.push_back(fmt::format("{:.4f}", c.unit_share));
    cells.push_back(fmt::format("{:.3f}", c.mean_length));
    cells.push_back(fmt::format("{:.3f}", c.quality_min));
    cells.push_back(fmt::format("{:.3f}", c.quality_mean));
    cells.push_back(fmt::format("{}", row.queries));
    cells.push_back(fmt::format("{:.2f} %", 100 * query_share(row)));
    const bool compared = has_delta_r(row);
    cells.push_back(compared ? fmt::format("{:.3f}", row.delta_r_max) : std::string(absent));
    cells.push_back(compared ? fmt::format("{:.4f}", row.delta_r_mean) : std::string(absent));
    cells.emplace_back();
    return cells;
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

TextTable measure_table(const Group& group, std::span<const MeshRow> all) {
    TextTable table{
        "Meshes: " + group.title,
        "L_R: share of edges of metric length 0.8 to 1.25; middle: by the metric at their middle "
        "alone; -exact: less that of the mesh of the exact field; unit: share from 1/√2 to √2. "
        "q: quality in the metric. share: of the processors' time, in the queries of the field." +
            correlation_text(group.rows),
        {{"field", Align::left},
         {"tets"},
         {"nodes"},
         {"s"},
         {"CPU s"},
         {"MB"},
         {"L_R"},
         {"-exact"},
         {"middle"},
         {"unit"},
         {"length"},
         {"q min"},
         {"q mean"},
         {"queries"},
         {"share"},
         {"δ_R max"},
         {"δ_R mean"},
         {"remark", Align::left}},
        {}};
    for (const MeshRow* row : group.rows) {
        table.rows.push_back(measure_cells(*row, exact_beside(*row, all)));
    }
    return table;
}

TextTable histogram_table(const Group& group) {
    TextTable table{"Edges by metric length [%]: " + group.title, "", {{"field", Align::left}}, {}};
    std::string from = "0";
    for (const double bound : length_bounds) {
        const std::string to = fmt::format("{:.3g}", bound);
        table.columns.push_back({from + "–" + to});
        from = to;
    }
    table.columns.push_back({from + "–"});
    for (const MeshRow* row : group.rows) {
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

nlohmann::ordered_json to_json(const MeshRow& row) {
    nlohmann::ordered_json json;
    const Case& c = row.setting;
    json["field"] = row.exact ? "exact" : c.structure;
    json["split"] = row.exact || !c.split ? "" : std::string(name_of(*c.split));
    json["setting"] = mesh_setting(row);
    json["mesher"] = name_of(row.mesher);
    json["error"] = row.error;
    if (!row.error.empty()) return json;
    const Conformity& m = row.conformity;
    json["tets"] = m.tets;
    json["nodes"] = m.nodes;
    json["edges"] = m.edges;
    json["L_R"] = m.l_r;
    json["L_R_middle"] = m.l_r_middle;
    json["unit_share"] = m.unit_share;
    json["mean_length"] = m.mean_length;
    json["histogram"] = m.histogram;
    json["quality_min"] = m.quality_min;
    json["quality_mean"] = m.quality_mean;
    json["creation_s"] = row.creation_s;
    json["mesh_s"] = row.seconds;
    json["mesh_processor_s"] = row.processor_seconds;
    json["queries"] = row.queries;
    json["query_s"] = row.query_seconds;
    json["peak_bytes"] = row.peak_bytes;
    if (has_delta_r(row)) {
        json["delta_R_max"] = row.delta_r_max;
        json["delta_R_mean"] = row.delta_r_mean;
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
    for (const Group& group : groups_of(rows)) {
        tables.push_back(measure_table(group, rows));
        tables.push_back(histogram_table(group));
    }
    std::string text;
    for (const TextTable& table : tables) {
        if (!text.empty()) text += '\n';
        text += render(table, style);
    }
    return text;
}

std::string mesh_json(const Provenance& provenance, const MeshSettings& settings,
                      std::span<const MeshRow> rows, bool complete) {
    nlohmann::ordered_json json;
    json["origin"] = fmt::format("controlspace {}, {}, {}, {} ({} cores), {}",
                                 version_text(provenance), provenance.compiler, provenance.flags,
                                 provenance.cpu, provenance.cores, provenance.date);
    json["command_line"] = provenance.command_line;
    for (const Setting<MeshSettings>& setting : mesh_settings()) {
        json["settings"][std::string(setting.key)] = to_string(setting.get(settings));
    }
    json["length_bounds"] = length_bounds;
    json["complete"] = complete;
    json["rows"] = nlohmann::ordered_json::array();
    for (const MeshRow& row : rows) json["rows"].push_back(to_json(row));
    return json.dump(1, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

}  // namespace controlspace
