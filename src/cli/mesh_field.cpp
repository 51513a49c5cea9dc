#include "cli/mesh_field.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "controlspace/fields/formula_field.h"
#include "controlspace/gmsh/gmsh_mesher.h"
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

GmshOptions gmsh_options(const MeshSettings& settings, GmshAlgorithm algorithm) {
    return {.algorithm = algorithm,
            .factor = settings.factor,
            .optimize = settings.optimize,
            .threads = settings.threads,
            .max_tets = settings.max_tets,
            .part = settings.body};
}

GmshRun start_mesh(const Box& domain, const ControlSpace& field, const MeshSettings& settings) {
    if (settings.start == MeshStart::coarse) {
        return mesh_with_gmsh(domain, coarse_field(domain), {.part = settings.body});
    }
    const bool hxt = settings.start == MeshStart::hxt;
    GmshOptions options =
        gmsh_options(settings, hxt ? GmshAlgorithm::hxt : GmshAlgorithm::delaunay);
    options.factor.reset();
    return mesh_with_gmsh(domain, field, options);
}

}  // namespace

Mesher chosen_mesher(Mesher requested, std::span<const Metric> metrics) {
    if (requested != Mesher::automatic) return requested;
    const bool anisotropic = std::any_of(metrics.begin(), metrics.end(), is_anisotropic);
    return anisotropic ? Mesher::mmg : Mesher::delaunay;
}

MmgOptions mmg_options(const MeshSettings& settings, const std::filesystem::path& folder) {
    return {.program = settings.mmg,
            .factor = settings.factor.value_or(mmg_factor),
            .rounds = settings.rounds,
            .time_limit_s = settings.time_limit_s,
            .folder = folder};
}

TetMesh make_mesh(const Box& domain, const ControlSpace& field, const MeshSettings& settings,
                  const std::filesystem::path& folder, MeshRow& row) {
    if (row.mesher == Mesher::mmg) {
        if (!settings.body) require_few_tets(domain, field, settings.max_tets);
        const GmshRun start = start_mesh(domain, field, settings);
        MmgOptions options = mmg_options(settings, folder);
        if (settings.body) options.hausdorff = 1e-3 * domain.edges().norm();
        MmgRun run = mesh_with_mmg(start.mesh, field, options);
        row.seconds = start.seconds + run.seconds + run.query_seconds;
        row.processor_seconds = start.processor_seconds + run.processor_seconds + run.query_seconds;
        row.queries = start.queries + run.queries;
        row.query_seconds = start.query_seconds + run.query_seconds;
        row.peak_bytes = run.peak_bytes;
        return std::move(run.mesh);
    }
    const bool hxt = row.mesher == Mesher::hxt;
    GmshRun run = mesh_with_gmsh(
        domain, field, gmsh_options(settings, hxt ? GmshAlgorithm::hxt : GmshAlgorithm::delaunay));
    row.seconds = run.seconds;
    row.processor_seconds = run.processor_seconds;
    row.queries = run.queries;
    row.query_seconds = run.query_seconds;
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
            std::vector<Metric> metrics(mesh.vertices.size());
            sample_parallel(field, mesh.vertices, metrics);
            write_medit_mesh(file(".mesh"), mesh);
            write_medit_solution(file(".sol"), metrics);
        }
    }
}

}  // namespace controlspace
