// SPDX-License-Identifier: Apache-2.0
#include "cli/mesh_field.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "cli/mesh_apart.h"
#include "controlspace/fields/formula_field.h"
#include "controlspace/mesh/mesh_files.h"
#include "controlspace/space/sample_parallel.h"
#include "io/text/medit.h"
#include "mesh/estimate.h"
#include "mesh/size_query.h"

namespace controlspace {
namespace {

bool is_anisotropic(const Metric& m) {
    return !is_isotropic(m) && lengths_differ(eigen_frame(m).lengths);
}

/// The field of MMG's first mesh: coarse, far from the requested one.
auto coarse_field(const Box& domain) {
    const double edge = domain.edges().maxCoeff() / 10;
    return FormulaField([edge](const Point&) { return Metric::isotropic(edge); });
}

GmshOptions gmsh_options(const MeshSettings& settings, bool hxt) {
    GmshOptions options = settings.gmsh;
    options.algorithm = hxt ? GmshAlgorithm::hxt : GmshAlgorithm::delaunay;
    return options;
}

/// The mesh that MMG starts from.
MeshRun start_mesh(const Box& domain, const ControlSpace& field, const MeshSettings& settings,
                   const std::filesystem::path& folder) {
    const double limit = settings.mmg.time_limit_s;
    if (settings.start == MeshStart::coarse) {
        return mesh_apart(domain, coarse_field(domain), {.part = settings.gmsh.part}, folder,
                          limit);
    }
    GmshOptions options = gmsh_options(settings, settings.start == MeshStart::hxt);
    options.factor.reset();
    return mesh_apart(domain, field, options, folder, limit);
}

MeshRun mesh_by_mmg(const Box& domain, const ControlSpace& field, const MeshSettings& settings,
                    const std::filesystem::path& folder) {
    if (!settings.gmsh.part) require_few_tets(domain, field, settings.gmsh.max_tets);
    const MeshRun start = start_mesh(domain, field, settings, folder);
    MmgOptions options = settings.mmg;
    options.factor = settings.gmsh.factor.value_or(mmg_factor);
    options.folder = folder;
    if (settings.gmsh.part) options.hausdorff = 1e-3 * domain.edges().norm();
    MeshRun run = mesh_with_mmg(start.mesh, field, options);
    run.cost += start.cost;
    return run;
}

}  // namespace

Mesher chosen_mesher(Mesher requested, std::span<const Metric> metrics) {
    if (requested != Mesher::automatic) return requested;
    const bool anisotropic = std::any_of(metrics.begin(), metrics.end(), is_anisotropic);
    return anisotropic ? Mesher::mmg : Mesher::delaunay;
}

TetMesh make_mesh(const Box& domain, const ControlSpace& field, const MeshSettings& settings,
                  const std::filesystem::path& folder, MeshRow& row) {
    MeshRun run = row.mesher == Mesher::mmg
                      ? mesh_by_mmg(domain, field, settings, folder)
                      : mesh_apart(domain, field, gmsh_options(settings, row.mesher == Mesher::hxt),
                                   folder, settings.mmg.time_limit_s);
    row.cost = run.cost;
    if (run.anisotropic) {
        spdlog::warn(
            "{}: the field is anisotropic, and Gmsh uses only its smallest lengths: use --mesher "
            "mmg",
            mesh_label(row));
    }
    return std::move(run.mesh);
}

void write_mesh(const std::filesystem::path& stem, const TetMesh& mesh, const ControlSpace& field,
                const MeshSettings& settings) {
    const auto file = [&](const char* ending) { return stem.string() + ending; };
    for (const std::string& kind : settings.files) {
        if (kind == "msh") {
            write_msh(file(".msh"), mesh);
        } else if (kind == "vtu") {
            write_vtu(file(".vtu"), mesh, field);
        } else {
            write_medit_mesh(file(".mesh"), mesh);
            write_medit_solution(file(".sol"), sample_parallel(field, mesh.vertices));
        }
    }
}

}  // namespace controlspace
