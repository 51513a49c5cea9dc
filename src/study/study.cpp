#include "study/study.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <utility>

#include "controlspace/error.h"
#include "study/file_readers.h"

namespace controlspace {
namespace {

std::vector<const CatalogueEntry*> chosen(const std::vector<std::string>& names,
                                          std::span<const CatalogueEntry> catalogue) {
    std::vector<const CatalogueEntry*> entries;
    const auto add = [&](const CatalogueEntry& entry) {
        if (std::find(entries.begin(), entries.end(), &entry) == entries.end()) {
            entries.push_back(&entry);
        }
    };
    for (const std::string& name : names) {
        bool known = name == "all" || name == "trees" || name == "anchored" || name == "baselines";
        for (const CatalogueEntry& entry : catalogue) {
            if (entry.id == name || entry.family == name || name == "all" ||
                (!name.empty() && entry.former_id == name)) {
                add(entry);
                known = true;
            }
        }
        if (!known) {
            std::vector<std::string_view> ids;
            for (const CatalogueEntry& entry : catalogue) ids.push_back(entry.id);
            throw InputError(fmt::format(
                "unknown structure '{}': give all, trees, anchored, baselines or some of {}", name,
                fmt::join(ids, ", ")));
        }
    }
    return entries;
}

/// Lists multiply: a slip in a study file should not ask for a year of work, or for all memory.
void require_few(std::size_t cases) {
    constexpr std::size_t most = 5000;
    if (cases > most) {
        throw InputError(fmt::format("the study has more than {} cases: shorten its lists", most));
    }
}

template <class T>
bool has(const std::vector<T>& values, const T& value) {
    return std::find(values.begin(), values.end(), value) != values.end();
}

/// Parameters that change nothing are a slip: they were meant for other sources.
void require_needed(const SourcesChoice& sources, const Run& run) {
    const Run defaults;
    const SourcesChoice plain;
    if (!is_sampled(sources) &&
        (run.rho != defaults.rho || run.s_a != defaults.s_a || run.s_n != defaults.s_n ||
         run.sampling != defaults.sampling || sources.h != plain.h)) {
        throw InputError(
            "h, rho, s_a, s_n and sampling are for sampled surfaces: leave them out with other "
            "sources");
    }
    if (sources.kind != SourcesKind::sphere &&
        (sources.radius != plain.radius || sources.centre != plain.centre)) {
        throw InputError("radius and centre are for the sphere: leave them out with other sources");
    }
    if (!is_vdb(sources) && sources.surface != plain.surface) {
        throw InputError(
            "vdb_size, vdb_size_per_radius, vdb_grid and vdb_isovalue are for sources out of a "
            ".vdb: leave them out with other sources");
    }
    if (sources.kind != SourcesKind::file && sources.in_file != plain.in_file) {
        throw InputError(
            "source_array, surface_angle, surface_h_min and surface_h_max are for files of "
            "sources: leave them out with other sources");
    }
    if (sources.kind != SourcesKind::planes && sources.slope != plain.slope) {
        throw InputError("slope is for the planes: leave it out with other sources");
    }
}

void require_reference(const SourcesChoice& sources, const Run& run) {
    if (!has(run.reference, ReferenceKind::published_sphere)) return;
    if (sources.kind != SourcesKind::sphere || run.field != Run{}.field) {
        throw InputError("reference published-sphere is for the sphere alone: use exact");
    }
    if (sources.centre != Point::Zero()) {
        throw InputError("reference published-sphere is around the origin: use exact");
    }
    if (std::any_of(run.s_n.begin(), run.s_n.end(), [](double s_n) { return s_n != 1; })) {
        throw InputError("reference published-sphere is isotropic: use exact, or s_n = 1");
    }
}

bool is_set(const std::vector<double>& list) {
    return std::any_of(list.begin(), list.end(), [](double x) { return x > 0; });
}

void require_sensible(const Study& study, const Run& run) {
    require_needed(study.sources, run);
    require_reference(study.sources, run);
    if (is_set(run.equal_delta) && is_set(run.equal_memory)) {
        throw InputError("equal_delta and equal_memory choose the same voxels: give one of them");
    }
    if ((is_set(run.equal_delta) || is_set(run.equal_memory)) &&
        (is_set(run.voxel) || run.voxel_factor != Run{}.voxel_factor)) {
        throw InputError(
            "equal_delta and equal_memory choose voxel and voxel_factor: leave those out");
    }
    if (study.sources.kind == SourcesKind::none && has(run.field, FieldKind::none)) {
        throw InputError("neither sources nor a field: give one of them");
    }
}

/// The same of the field's parameters; runs may differ in their fields.
void require_needed_fields(const Study& study) {
    const FieldChoice& field = study.sources.field;
    const FieldChoice plain;
    const auto any_run_has = [&](FieldKind kind) {
        return std::any_of(study.runs.begin(), study.runs.end(),
                           [&](const Run& run) { return has(run.field, kind); });
    };
    const bool file = any_run_has(FieldKind::file);
    if (file && field.file.empty()) {
        throw InputError("field = \"file\" needs field_file: name a .vdb");
    }
    if (!file && (!field.file.empty() || field.vdb != plain.vdb)) {
        throw InputError(
            "field_file, field_grid and field_density_sizes are for field = \"file\": set that");
    }
    const bool sphere = any_run_has(FieldKind::sphere);
    const bool planes = any_run_has(FieldKind::planes);
    if (!sphere && (field.radius != plain.radius || field.centre != plain.centre)) {
        throw InputError("field_radius and field_centre are for field = \"sphere\": set that");
    }
    if (!planes && field.slope != plain.slope) {
        throw InputError("field_slope is for field = \"planes\": set that");
    }
    if (!sphere && !planes && field.lengths != plain.lengths) {
        throw InputError(
            "field_lengths, field_growth and field_largest are for field = \"sphere\" or "
            "\"planes\": set one of them");
    }
}

/// Replaces each case by one for each value; the first list multiplied varies slowest.
template <class Value, class Assign>
void multiply(std::vector<Case>& cases, const std::vector<Value>& values, Assign&& assign) {
    require_few(cases.size() * values.size());
    std::vector<Case> product;
    product.reserve(cases.size() * values.size());
    for (const Case& c : cases) {
        for (const Value& value : values) assign(product.emplace_back(c), value);
    }
    cases = std::move(product);
}

std::vector<Case> settings_of(const Study& study, const Run& run) {
    std::vector<Case> cases(1);
    cases.front().sources = study.sources;
    multiply(cases, run.field, [](Case& c, FieldKind kind) { c.sources.field.kind = kind; });
    multiply(cases, run.sampling, [](Case& c, Sampling s) { c.sources.sampling = s; });
    multiply(cases, run.rho, [](Case& c, double rho) { c.sources.rho = rho; });
    multiply(cases, run.s_a, [](Case& c, double s_a) { c.sources.s_a = s_a; });
    multiply(cases, run.s_n, [](Case& c, double s_n) { c.sources.s_n = s_n; });
    multiply(cases, run.g_r, [](Case& c, double g_r) { c.g_r = g_r; });
    multiply(cases, run.reference, [](Case& c, ReferenceKind kind) { c.reference = kind; });
    multiply(cases, run.law, [](Case& c, GradationLaw law) { c.law = law; });
    multiply(cases, run.schedule, [](Case& c, GradationSchedule s) { c.schedule = s; });
    multiply(cases, run.epsilon, [](Case& c, double epsilon) { c.epsilon = epsilon; });
    multiply(cases, run.tau, [](Case& c, double tau) { c.tau = tau; });
    return cases;
}

std::optional<double> unless_zero(double x) {
    return x == 0 ? std::nullopt : std::optional<double>(x);
}

/// One structure under one setting: what a structure does not have does not multiply it.
std::vector<Case> variants_of(const CatalogueEntry& entry, const Run& run, const Case& setting) {
    // Nothing but sources makes grids in levels finer.
    if (entry.has<VoxelLevels>() && has_field(setting.sources)) return {};
    std::vector<Case> cases{setting};
    cases.front().structure = entry.id;
    if (entry.has<SplitRules>()) {
        multiply(cases, run.splits, [](Case& c, SplitRule split) { c.split = split; });
        multiply(cases, run.kd_depth, [](Case& c, int depth) { c.max_depth = depth; });
    } else if (entry.has<SourceLeaves>()) {
        multiply(cases, run.octree_depth, [](Case& c, int depth) { c.max_depth = depth; });
    }
    if (entry.has<SourceLeaves>()) {
        multiply(cases, run.target_delta, [&](Case& c, double delta) {
            c.target_delta = unless_zero(delta);
            // Adapted trees heed no rule: one of the rules stands for all.
            if (c.target_delta && c.split) c.split = run.splits.front();
        });
    }
    if (entry.has<VoxelSize>()) {
        multiply(cases, run.equal_delta,
                 [](Case& c, double delta) { c.equal_delta = unless_zero(delta); });
        multiply(cases, run.equal_memory,
                 [](Case& c, double mb) { c.equal_memory = unless_zero(mb); });
        multiply(cases, run.voxel, [](Case& c, double edge) { c.voxel = unless_zero(edge); });
    }
    if (entry.has<VoxelLevels>()) {
        multiply(cases, run.voxel_factor, [](Case& c, double factor) { c.voxel_factor = factor; });
    }
    if (entry.has<MetricNodes>()) {
        multiply(cases, run.neighbourhood, [](Case& c, Neighbourhood n) {
            if (!c.target_delta) c.neighbourhood = n;  // an adapted tree is not graded
        });
        multiply(cases, run.node_values, [](Case& c, NodeValues v) {
            if (!c.target_delta) c.node_values = v;  // an adapted tree is exact at nodes
        });
    }
    if (entry.has<CompactForm>()) {
        multiply(cases, run.frozen, [](Case& c, Frozen frozen) { c.frozen = frozen; });
    }
    if (entry.has<Pruning>()) {
        multiply(cases, run.prune_delta,
                 [](Case& c, double delta) { c.prune_delta = unless_zero(delta); });
    }
    return cases;
}

}  // namespace

std::vector<Case> expand(const Study& study, std::span<const CatalogueEntry> catalogue) {
    require_needed_fields(study);
    std::vector<Case> cases;
    for (const Run& run : study.runs) {
        require_sensible(study, run);
        const auto entries = chosen(run.structures, catalogue);
        for (const Case& setting : settings_of(study, run)) {
            for (const CatalogueEntry* entry : entries) {
                for (const Case& c : variants_of(*entry, run, setting)) {
                    if (std::find(cases.begin(), cases.end(), c) == cases.end()) {
                        cases.push_back(c);
                    }
                }
                require_few(cases.size());
            }
        }
    }
    if (cases.empty()) {
        throw InputError(
            "the study has no cases: give at least one structure, and for a field one that is not "
            "a "
            "grid in levels");
    }
    return cases;
}

}  // namespace controlspace
