#include "controlspace/study/workload.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <string_view>
#include <utility>

#include "controlspace/error.h"
#include "controlspace/io/read_sources.h"
#include "controlspace/measure/reference.h"
#include "controlspace/space/control_space.h"

namespace controlspace {
namespace {

[[noreturn]] void fail_without_reader(const std::filesystem::path& file) {
    throw InputError(
        fmt::format("{}: this program is built without the library that reads {} files",
                    file.string(), lower_case_extension(file)));
}

/// Formats that other libraries read.
bool needs_reader(const std::string& ending) {
    constexpr std::string_view endings[] = {".vdb", ".vtu",  ".vtp", ".stl",  ".obj", ".ply",
                                            ".off", ".step", ".stp", ".iges", ".igs", ".brep"};
    return std::ranges::count(endings, ending) > 0;
}

std::vector<PointSource> make_sources(const SourcesChoice& s, std::uint64_t seed,
                                      const FileReaders& readers) {
    switch (s.kind) {
        case SourcesKind::sphere:
            return scatter_sphere({.centre = s.centre,
                                   .radius = s.radius,
                                   .h = s.h,
                                   .s_a = s.s_a,
                                   .s_n = s.s_n,
                                   .rho = s.rho},
                                  s.sampling, seed);
        case SourcesKind::planes:
            return scatter_planes(
                {.h = s.h, .s_a = s.s_a, .s_n = s.s_n, .rho = s.rho, .slope = s.slope}, s.sampling,
                seed);
        case SourcesKind::none:
            return {};
        case SourcesKind::file:
            break;
    }
    return read_source_file(s, readers);
}

AnalyticField field_of(const FieldChoice& choice, const FileReaders& readers) {
    if (choice.kind != FieldKind::file) return make_field(choice);
    if (!readers.vdb_field) fail_without_reader(choice.file);
    return readers.vdb_field(choice);
}

Box domain_of(const Study& study, const SourcesChoice& choice, const Workload& workload) {
    if (study.domain) return *study.domain;
    if (workload.field.field && workload.field.field->domain() != Box::everywhere()) {
        return workload.field.field->domain();
    }
    if (choice.kind != SourcesKind::file) return {Point::Constant(-1), Point::Constant(1)};
    std::vector<Point> positions;
    positions.reserve(workload.sources.size());
    for (const PointSource& source : workload.sources) positions.push_back(source.position);
    return bounding_box(positions, study.margin);
}

double finest_length_of(const Workload& workload) {
    if (!workload.field.field) return finest_length(workload.sources);
    if (workload.sources.empty()) return workload.field.finest_length;
    return std::min(workload.field.finest_length, finest_length(workload.sources));
}

}  // namespace

namespace {

std::vector<PointSource> read_one(const SourcesChoice& choice, const FileReaders& readers) {
    const std::string ending = lower_case_extension(choice.file);
    if (const auto reader = readers.sources.find(ending); reader != readers.sources.end()) {
        return reader->second(choice);
    }
    if (needs_reader(ending)) fail_without_reader(choice.file);
    return read_sources(choice.file, choice.in_file.array);
}

}  // namespace

std::vector<PointSource> read_source_file(const SourcesChoice& choice, const FileReaders& readers) {
    std::vector<PointSource> sources;
    for (const auto& file : files_of(choice)) {
        SourcesChoice one = choice;
        one.file = file;
        const auto more = read_one(one, readers);
        sources.insert(sources.end(), more.begin(), more.end());
    }
    return sources;
}

Workload make_workload(const Study& study, const SourcesChoice& choice,
                       const FileReaders& readers) {
    Workload workload;
    workload.sources = make_sources(choice, study.seed, readers);
    if (has_field(choice)) workload.field = field_of(choice.field, readers);
    workload.domain = domain_of(study, choice, workload);
    require_defined(workload.field, workload.domain, std::string(name_of(choice.field.kind)));
    for (std::size_t i = 0; i < workload.sources.size(); ++i) {
        require_valid(workload.sources[i], i, workload.domain);
    }
    workload.finest_length = finest_length_of(workload);
    return workload;
}

SpaceOptions space_options(const Study& study, const Case& c, const Workload& workload,
                           std::span<const CaseParameter> parameters) {
    constexpr double gib = 1024.0 * 1024 * 1024;
    SpaceOptions options;
    options.domain = workload.domain;
    options.l_min = c.tau;
    options.tolerance = c.epsilon;
    options.finest_length = workload.finest_length;
    options.ratio = c.g_r;
    options.max_bytes = static_cast<std::size_t>(std::ceil(study.max_memory_gib * gib));
    if (c.split) options.split = *c.split;
    if (c.max_depth) (c.split ? options.kd_depth : options.octree_depth) = *c.max_depth;
    options.voxel = c.voxel.value_or(0);
    if (c.voxel_factor) options.voxel_factor = *c.voxel_factor;
    options.prune_delta = c.prune_delta.value_or(0);
    if (c.interpolation) options.quadratic_form = *c.interpolation;
    options.intersection = c.intersection;
    for (const CaseParameter& parameter : parameters) {
        if (parameter.apply && !values_of(parameter, c).empty()) parameter.apply(c, options);
    }
    require_valid(options);
    return options;
}

std::shared_ptr<const ControlSpace> make_reference(const Study& study, const Case& c,
                                                   const Workload& workload) {
    return c.reference->make(study, c, workload);
}

const ReferenceKind& exact_reference_kind() {
    static const ReferenceKind exact{
        "exact", "intersection of the cones of all sources",
        [](const Study& study, const Case& c,
           const Workload& workload) -> std::shared_ptr<const ControlSpace> {
            return exact_reference(workload.sources, c.g_r, largest_metric(workload.domain),
                                   study.reference_tolerance, c.intersection, workload.field.field);
        }};
    return exact;
}

ReferenceProbes make_reference_probes(const Study& study, const Case& c, const Workload& workload) {
    const auto field = make_reference(study, c, workload);
    return {make_probes(*field, cell_centres(workload.domain, study.probe_grid)),
            make_probes(*field, cell_centres(workload.domain, study.fine_probe_grid))};
}

}  // namespace controlspace
