#include "app/mesh.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "app/input_study.h"
#include "app/peak_memory.h"
#include "app/readers.h"
#include "app/signals.h"
#include "app/standard_output.h"
#include "app/threads.h"
#include "baselines/catalogue.h"
#include "error.h"
#include "fields/formula_field.h"
#include "measure/accuracy.h"
#include "mesh/estimate.h"
#include "mesh/gmsh_mesher.h"
#include "mesh/mesh_rows.h"
#include "mesh/mesh_settings.h"
#include "mesh/mmg_mesher.h"
#include "mesh/size_query.h"
#include "mesh/write_medit.h"
#include "mesh/write_msh.h"
#include "mesh/write_vtu.h"
#include "sources/write_medit_sources.h"
#include "spaces/space_field.h"
#include "study/results.h"
#include "study/run.h"

namespace controlspace {
namespace {

namespace fs = std::filesystem;

constexpr const char* results_file = "meshes.json";

/// What cases with the same exact field share.
struct Reference {
    Case first;  ///< of these cases
    Workload workload;
    std::shared_ptr<const MetricField> field;
    Probes probes;
    Mesher mesher = Mesher::delaunay;  ///< the choice of `auto` taken
};

bool share_reference(const Case& a, const Case& b) {
    return a.sources == b.sources && a.reference == b.reference && a.g_r == b.g_r;
}

bool is_anisotropic(std::span<const Metric> metrics) {
    return std::any_of(metrics.begin(), metrics.end(), [](const Metric& m) {
        return !is_isotropic(m) && lengths_differ(eigen_frame(m).lengths);
    });
}

Reference make_shared_reference(const Study& study, const Case& c, Mesher asked) {
    Reference reference{c, make_workload(study, c.sources, file_readers()), nullptr, {}, asked};
    reference.field = make_reference(study, c, reference.workload);
    reference.probes =
        make_probes(*reference.field, cell_centres(reference.workload.domain, study.probe_grid));
    if (asked == Mesher::automatic) {
        reference.mesher =
            is_anisotropic(reference.probes.reference) ? Mesher::mmg : Mesher::delaunay;
    }
    return reference;
}

/// What MMG's first mesh is made for: it is far from what is asked, and coarse.
auto coarse_field(const Box& domain) {
    const double edge = domain.edges().maxCoeff() / 10;
    return FormulaField([edge](const Point&) { return Metric::isotropic(edge); });
}

/// Makes meshes, and keeps what lies in the folder of results up to date.
class MeshJob {
public:
    MeshJob(Study study, MeshSettings settings, const MeshOptions& options)
        : study_(std::move(study)),
          settings_(std::move(settings)),
          quiet_(options.quiet),
          cases_(expand(study_, structures())),
          provenance_(current_provenance()) {
        provenance_.command_line = options.command_line;
        folder_ = results_path(study_, provenance_);
    }

    void run(Interruption& interruption);

    const fs::path& folder() const { return folder_; }
    const std::vector<MeshRow>& rows() const { return rows_; }

private:
    void require_runnable();
    const Reference& reference_of(const Case& c);
    void mesh_case(const Case& c, const Reference& reference, bool exact,
                   Interruption& interruption);
    GmshOptions gmsh_options(GmshAlgorithm algorithm) const;
    MmgOptions mmg_options() const;
    GmshRun start_mesh(const Box& domain, const MetricField& field) const;
    TetMesh make_mesh(const Reference& reference, const MetricField& field, MeshRow& row) const;
    void write_files(const MeshRow& row, const TetMesh& mesh, const MetricField& field) const;
    void record(bool complete) const;

    const Study study_;
    const MeshSettings settings_;
    const bool quiet_;
    const std::vector<Case> cases_;
    Provenance provenance_;
    fs::path folder_;
    std::optional<Reference> reference_;
    std::vector<MeshRow> rows_;
};

const Reference& MeshJob::reference_of(const Case& c) {
    if (!reference_ || !share_reference(reference_->first, c)) {
        reference_.reset();  // its memory first
        reference_ = make_shared_reference(study_, c, settings_.mesher);
    }
    return *reference_;
}

void MeshJob::run(Interruption& interruption) {
    require_runnable();
    make_results_folder(folder_, results_file);
    record(false);
    const Case* last = nullptr;
    for (const Case& c : cases_) {
        const Reference& reference = reference_of(c);
        const bool new_field = last == nullptr || !share_reference(*last, c);
        if (settings_.exact && new_field) mesh_case(c, reference, true, interruption);
        mesh_case(c, reference, false, interruption);
        last = &c;
    }
    record(true);
}

/// What is wrong from the start leaves no folder; what is wrong with a later case makes a row.
void MeshJob::require_runnable() {
    for (const Case& c : cases_) require_set_voxels(c);
    const Reference& reference = reference_of(cases_.front());
    for (const Case& c : cases_) {
        if (c.sources == reference.first.sources) space_options(study_, c, reference.workload);
    }
    if (reference.mesher == Mesher::mmg) require_mmg(mmg_options());
}

void MeshJob::mesh_case(const Case& c, const Reference& reference, bool exact,
                        Interruption& interruption) {
    MeshRow row;
    row.setting = c;
    row.exact = exact;
    row.mesher = reference.mesher;
    restart_peak_memory();
    try {
        std::unique_ptr<ControlSpace> space;
        std::unique_ptr<MetricField> space_field;
        if (!exact) {
            Measures measures;
            space = make_and_fill(study_, c, entry_of(c, structures()), reference.workload,
                                  measures, {});
            row.creation_s = measures.insert_s + measures.gradation_s;
            const Accuracy delta_r = accuracy(*space, reference.probes);
            row.delta_r_max = delta_r.max;
            row.delta_r_mean = delta_r.mean;
            space_field = std::make_unique<SpaceAsField>(*space);
        }
        const MetricField& field = exact ? *reference.field : *space_field;
        const TetMesh mesh = make_mesh(reference, field, row);
        row.peak_bytes = std::max(row.peak_bytes, peak_memory());
        row.conformity = conformity(mesh, *reference.field);
        const auto whole = interruption.postpone();
        write_files(row, mesh, field);
    } catch (const std::bad_alloc&) {
        row.error = "out of memory: ask for larger lengths";
    } catch (const std::exception& error) {
        row.error = error.what();
    }
    const auto whole = interruption.postpone();
    rows_.push_back(row);
    record(false);
    if (!row.error.empty()) {
        spdlog::warn("{}: {}", mesh_label(row), row.error);
    } else if (!quiet_) {
        print_error(fmt::format("mesh {}: {}, {}: {} tets, L_R {:.4f}, {:.1f} s\n", rows_.size(),
                                mesh_label(row), setting_label(c), row.conformity.tets,
                                row.conformity.l_r, row.seconds));
    }
}

GmshOptions MeshJob::gmsh_options(GmshAlgorithm algorithm) const {
    return {.algorithm = algorithm,
            .factor = settings_.factor,
            .optimize = settings_.optimize,
            .threads = settings_.threads,
            .max_tets = settings_.max_tets};
}

MmgOptions MeshJob::mmg_options() const {
    return {.program = settings_.mmg,
            .factor = settings_.factor.value_or(mmg_factor),
            .rounds = settings_.rounds,
            .time_limit_s = settings_.time_limit_s,
            .folder = folder_};
}

GmshRun MeshJob::start_mesh(const Box& domain, const MetricField& field) const {
    if (settings_.start == MeshStart::coarse) return mesh_with_gmsh(domain, coarse_field(domain));
    const bool hxt = settings_.start == MeshStart::hxt;
    GmshOptions options = gmsh_options(hxt ? GmshAlgorithm::hxt : GmshAlgorithm::delaunay);
    options.factor.reset();
    return mesh_with_gmsh(domain, field, options);
}

TetMesh MeshJob::make_mesh(const Reference& reference, const MetricField& field,
                           MeshRow& row) const {
    const Box& domain = reference.workload.domain;
    if (reference.mesher == Mesher::mmg) {
        require_few_tets(domain, field, settings_.max_tets);
        const GmshRun start = start_mesh(domain, field);
        MmgRun run = mesh_with_mmg(start.mesh, field, mmg_options());
        row.seconds = start.seconds + run.seconds + run.query_seconds;
        row.processor_seconds = start.processor_seconds + run.processor_seconds + run.query_seconds;
        row.queries = start.queries + run.queries;
        row.query_seconds = start.query_seconds + run.query_seconds;
        row.peak_bytes = run.peak_bytes;
        return std::move(run.mesh);
    }
    const bool hxt = reference.mesher == Mesher::hxt;
    GmshRun run = mesh_with_gmsh(domain, field,
                                 gmsh_options(hxt ? GmshAlgorithm::hxt : GmshAlgorithm::delaunay));
    row.seconds = run.seconds;
    row.processor_seconds = run.processor_seconds;
    row.queries = run.queries;
    row.query_seconds = run.query_seconds;
    if (run.anisotropic) {
        spdlog::warn(
            "{}: the field is anisotropic, and Gmsh takes its smallest lengths: --mesher mmg "
            "follows it",
            mesh_label(row));
    }
    return std::move(run.mesh);
}

void MeshJob::write_files(const MeshRow& row, const TetMesh& mesh, const MetricField& field) const {
    std::string name = fmt::format("{:02}-{}", rows_.size(), mesh_label(row));
    const auto unfit = [](char c) { return c == ' ' || c == '/' || c == ',' || c == '<'; };
    std::replace_if(name.begin(), name.end(), unfit, '-');
    const auto file = [&](const char* ending) { return folder_ / (name + ending); };
    for (const std::string& kind : settings_.files) {
        if (kind == "msh") {
            write_msh(file(".msh"), mesh);
        } else if (kind == "vtu") {
            write_vtu(file(".vtu"), mesh, field);
        } else {
            std::vector<Metric> metrics(mesh.vertices.size());
            field.evaluate(mesh.vertices, metrics);
            write_medit_mesh(file(".mesh"), mesh);
            write_medit_solution(file(".sol"), metrics);
        }
    }
}

void MeshJob::record(bool complete) const {
    replace_file(folder_ / results_file, mesh_json(provenance_, settings_, rows_, complete));
    if (!complete) return;
    const std::string head =
        fmt::format("# {}\n\n{}\n\n", study_.name, origin_text(provenance_, complete));
    replace_file(folder_ / "summary.md", head + mesh_tables(rows_, TableStyle::markdown));
}

}  // namespace

bool mesh(const MeshOptions& options) {
    Study study = study_of_input(options.input, options.settings);
    if (study.name == Study{}.name) study.name = "mesh";
    MeshSettings settings;
    apply(options.settings, mesh_settings(), settings);
    const auto threads = limit_threads(study.threads);
    Interruption interruption;
    MeshJob job(std::move(study), std::move(settings), options);
    {
        const Interruption::Watch watch(interruption, nullptr, [&] {
            print_error(fmt::format("controlspace: interrupted: {} meshes are in {}\n",
                                    job.rows().size(), job.folder().string()));
        });
        job.run(interruption);
    }
    print(mesh_tables(job.rows(), TableStyle::terminal));
    print(fmt::format("\nMeshes: {}\n", job.folder().string()));
    return std::all_of(job.rows().begin(), job.rows().end(),
                       [](const MeshRow& row) { return row.error.empty(); });
}

}  // namespace controlspace
