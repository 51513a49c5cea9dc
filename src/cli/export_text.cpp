// SPDX-License-Identifier: Apache-2.0
// Formats of `export` that need no external library: tables, views and solutions.
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <memory>

#include "cli/export.h"
#include "controlspace/geometry/extent.h"
#include "controlspace/io/read_sources.h"
#include "controlspace/space/sample_parallel.h"
#include "io/text/medit.h"
#include "io/text/metric_rows.h"
#include "io/text/pos.h"
#include "refuse.h"

namespace controlspace {
namespace {

std::string write_solution(const Export& e, const std::filesystem::path& mesh) {
    const std::vector<Point> vertices = read_medit_vertices(mesh);
    write_medit_solution(e.output, sample_parallel(*e.filled.space, vertices));
    report_outside(vertices, "vertices", e.filled.space->domain());
    return written(e,
                   fmt::format("metrics at the {} vertices of {}", vertices.size(), mesh.string()));
}

std::string write_node_table(const Export& e) {
    const auto nodes = control_nodes(*e.filled.space, Neighbourhood::faces);
    if (!nodes) refuse("this structure has no control nodes: name a .vti");
    write_sources(e.output, sources_from(positions(nodes->graph), nodes->metrics));
    return written(e, fmt::format("{} control nodes", nodes->metrics.size()));
}

std::string write_view(const Export& e) {
    const PosCells cells = write_pos_cells(e.output, *e.filled.space);
    if (cells.has_tensors) {
        spdlog::warn(
            "{} holds tensors, which Gmsh's default mesher ignores in a view: use them with MMG or "
            "BAMG, or write a .sol",
            e.output.string());
    }
    constexpr double few = 0.01;
    if (cells.off > few) {
        spdlog::warn("{}: at up to {:.1f} % of places lengths are off by more than 1 %: write {}",
                     e.output.string(), std::min(100., 100 * cells.off),
                     cells.has_tensors ? "a .sol, exact at the vertices of a mesh"
                                       : "a structure that is linear in each cell (K_oV)");
    }
    const bool is_flat = flat_axis(e.filled.space->domain()).has_value();
    return written(e, fmt::format("{} {}", cells.count, is_flat ? "quadrilaterals" : "hexahedra"));
}

}  // namespace

std::vector<FieldFormat> add_text_formats(Options& options) {
    const auto mesh = std::make_shared<std::filesystem::path>();
    const std::string group = "A .sol or .solb file";
    options.add({"--mesh", "FILE",
                 "The mesh (.mesh, .meshb) at whose vertices the field is sampled", group},
                *mesh);
    return {{{".csv"}, write_node_table},
            {{".pos"}, write_view},
            {{".sol", ".solb"},
             [mesh](const Export& e) { return write_solution(e, *mesh); },
             {group},
             [mesh](const auto&, const auto&) {
                 if (mesh->empty()) refuse("name the mesh of the solution by --mesh");
             }}};
}

}  // namespace controlspace
