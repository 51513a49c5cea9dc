// SPDX-License-Identifier: Apache-2.0
// The command `mesh`: makes meshes with structures as size fields.
#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <utility>

#include "cli/command.h"
#include "cli/filled_space.h"
#include "cli/formats.h"
#include "cli/input_study.h"
#include "cli/mesh_field.h"
#include "cli/mesh_folder.h"
#include "cli/options.h"
#include "cli/paper_reference.h"
#include "cli/standard_output.h"
#include "cli/threads.h"
#include "controlspace/baselines/catalogue.h"
#include "controlspace/measure/accuracy.h"
#include "controlspace/space/control_space_file.h"
#include "controlspace/study/run.h"
#include "refuse.h"

namespace controlspace {
namespace {

/// What cases with the same exact field share.
struct Reference {
    Case first;  ///< of these cases
    Workload workload;
    std::shared_ptr<const ControlSpace> field;
    Probes probes;
    Mesher mesher = Mesher::delaunay;  ///< the choice for `auto`
};

/// Lets a domain that nobody chose reach around the part, where the field is defined there.
void grow_to(const Part& part, const Study& study, Workload& workload) {
    const auto& continuous = workload.field.field;
    if (study.domain || (continuous && continuous->domain() != Box::everywhere())) return;
    Box& domain = workload.domain;
    const Box grown{domain.low.cwiseMin(part.box.low), domain.high.cwiseMax(part.box.high)};
    if (grown == domain) return;
    print_error(fmt::format("the domain {} grows to the part: {} (--domain sets another)\n",
                            to_string(domain), to_string(grown)));
    domain = grown;
}

Reference make_shared_reference(const Study& study, const Case& c, const MeshSettings& settings) {
    Reference reference{c, make_workload(study, c.sources, file_readers()), nullptr, {}};
    if (settings.gmsh.part) grow_to(*settings.gmsh.part, study, reference.workload);
    reference.field = make_reference(study, c, reference.workload);
    reference.probes =
        make_probes(*reference.field, cell_centres(reference.workload.domain, study.probe_grid));
    reference.mesher = chosen_mesher(settings.mesher, reference.probes.reference);
    return reference;
}

/// Meshes the structure of a case.
void mesh_case(const Study& study, const Case& c, const Reference& reference, MeshFolder& folder) {
    const MeshRow row{.setting = c, .mesher = reference.mesher};
    std::unique_ptr<ControlSpace> space;
    const auto make = [&](MeshRow& made) -> const ControlSpace& {
        start_library_of(c.structure);
        Filled filled = make_and_fill(study, c, program_rows(), reference.workload);
        space = std::move(filled.space);
        made.shortfall = filled.creation.shortfall;
        made.creation_s = filled.creation.insert_s.front() + filled.creation.gradation_s.front();
        made.delta_r = accuracy(*space, reference.probes);
        return *space;
    };
    folder.add(row, reference.workload.domain, *reference.field, make);
}

/// Meshes the cases of a study, and their exact fields.
void mesh_study(const Study& study, const DefaultTarget& target, MeshFolder& folder) {
    const MeshSettings& settings = folder.settings();
    const std::vector<Case> cases = expand(study, program_rows());
    for (const Case& c : cases) require_set_voxels(c);
    std::optional reference = make_shared_reference(study, cases.front(), settings);
    // What is wrong from the start leaves no folder; what is wrong with a later case makes a row.
    if (!settings.gmsh.part) require_volume(reference->workload.domain);
    for (const Case& c : cases) {
        if (c.sources == cases.front().sources) space_options(study, c, reference->workload);
    }
    if (reference->mesher == Mesher::mmg) require_mmg(settings.mmg);
    folder.begin();
    bool is_new_field = true;
    for (Case c : cases) {
        if (!share_probes(reference->first, c)) {
            reference.reset();  // its memory first
            reference = make_shared_reference(study, c, settings);
            is_new_field = true;
        }
        target.set(c, reference->workload);
        if (settings.exact && std::exchange(is_new_field, false)) {
            folder.add({.setting = c, .exact = true, .mesher = reference->mesher},
                       reference->workload.domain, *reference->field);
        }
        mesh_case(study, c, *reference, folder);
    }
    folder.end();
}

/// Meshes a control space that was saved; it is the reference too.
void mesh_saved(const std::filesystem::path& file, const ControlSpace& space, int probe_grid,
                MeshFolder& folder) {
    if (!folder.settings().gmsh.part) require_volume(space.domain());
    MeshRow row{.saved = file};
    const auto recipe = recipe_of(space);
    row.setting.structure = recipe ? recipe->structure : "pieces";
    const auto probes = make_probes(space, cell_centres(space.domain(), probe_grid));
    row.mesher = chosen_mesher(folder.settings().mesher, probes.reference);
    if (row.mesher == Mesher::mmg) require_mmg(folder.settings().mmg);
    folder.begin();
    folder.add(std::move(row), space.domain(), space);
    folder.end();
}

/// Settings of making, which do not apply to a control space that was saved.
GivenSettings without_settings_of_meshing(const GivenSettings& given) {
    GivenSettings left = given;
    std::erase_if(left, [&](const auto& setting) {
        const auto is_it = [&](const auto& p) { return p.key == setting.first; };
        return setting.first == "threads" || setting.first == "unit" ||
               std::ranges::any_of(mesh_parameters(), is_it) ||
               std::ranges::any_of(study_parameters(), [&](const Parameter<Study>& p) {
                   return is_it(p) && (p.use == Use::results || p.use == Use::accuracy);
               });
    });
    return left;
}

/// What is filled; none for the domain.
std::shared_ptr<const Part> part_of(const MeshSettings& settings,
                                    const std::filesystem::path& input, const Study& study) {
    std::filesystem::path file = settings.part;
    if (file.empty() && input.extension() != ".toml") {
        std::vector<std::filesystem::path> parts = input_files_of(study.sources);
        std::erase_if(parts, [](const auto& name) { return !is_part(name); });
        if (parts.size() > 1) {
            refuse("{} and {} are parts: name the one to mesh (--part FILE), or --part box",
                   parts[0].string(), parts[1].string());
        }
        if (!parts.empty()) file = parts.front();
    }
    if (file.empty()) file = "box";
    if (file == "box") return nullptr;
    return std::make_shared<const Part>(
        read_part(file, settings.part_crease, study.sources.in_file));
}

int mesh(const Job& job, const std::string& command_line) {
    const GivenSettings given = given_settings(job.given);
    const bool is_saved = is_control_space(job.input);
    if (is_saved) require_no_settings(job.input, without_settings_of_meshing(given));
    Study study = study_of_input(is_saved ? "" : job.input, given);
    if (study.name == Study{}.name) study.name = "mesh";
    MeshSettings settings;
    apply(given, mesh_parameters(), settings);
    settings.gmsh.part = part_of(settings, job.input, study);
    const auto threads = limit_threads(study.threads);
    Interruption interruption;
    const auto saved = is_saved ? load_saved(job.input) : nullptr;
    MeshFolder folder(study, std::move(settings), command_line, job.quiet, interruption);
    {
        const Interruption::Watch watch(interruption, nullptr, [&] {
            folder.remove_files_of_meshers();
            print_error(fmt::format("controlspace: interrupted: meshes in {}: {}\n",
                                    folder.path().string(), folder.rows().size()));
        });
        if (saved) {
            mesh_saved(job.input, *saved, study.probe_grid, folder);
        } else {
            mesh_study(study, {job.input, given}, folder);
        }
    }
    print(mesh_tables(folder.rows()));
    print(fmt::format("\nMeshes: {}\n", folder.path().string()));
    const bool as_requested = std::ranges::all_of(folder.rows(), [](const MeshRow& row) {
        return row.error.empty() && row.shortfall.empty();
    });
    return as_requested ? 0 : some_failed;
}

}  // namespace

Action add_mesh(Options& options) {
    const auto job = std::make_shared<Job>();
    add_filled_input(options, job->input);
    options.add_parameters(mesh_parameters(), MeshSettings{}, "Meshing", job->given);
    options.set_note("Of settings with lists, all combinations are meshed.");
    options.add_settings(one_structure(), Study{}, job->given,
                         {Use::making, Use::reading, Use::results, Use::accuracy});
    add_quiet(options, job->quiet);
    return [job](const std::string& command_line) { return mesh(*job, command_line); };
}

}  // namespace controlspace
