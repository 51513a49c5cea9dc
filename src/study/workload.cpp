// SPDX-License-Identifier: Apache-2.0
#include "controlspace/study/workload.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>

#include "controlspace/fields/formula_field.h"
#include "controlspace/fields/mixture.h"
#include "controlspace/io/read_sources.h"
#include "controlspace/measure/access_places.h"
#include "controlspace/measure/reference.h"
#include "controlspace/space/control_space.h"
#include "refuse.h"
#include "study/file_endings.h"

namespace controlspace {
namespace {

[[noreturn]] void fail_without_reader(const std::filesystem::path& file) {
    refuse_at(file, "this program is built without the library that reads {} files",
              lower_case_extension(file));
}

/// Formats that other libraries read.
bool needs_reader(const std::string& ending) {
    return has_ending(vdb_endings, ending) || has_ending(vtk_endings, ending) ||
           has_ending(part_endings(), ending);
}

AnalyticField field_of(const FieldChoice& choice, const FileReaders& readers) {
    if (choice.kind != FieldKind::file) return make_field(choice);
    if (!readers.vdb_field) fail_without_reader(choice.file);
    return readers.vdb_field(choice);
}

std::vector<DistanceField> distances_of(const SourcesChoice& choice, const FileReaders& readers) {
    std::vector<DistanceField> distances;
    for (const Primitive& primitive : choice.primitives) {
        if (primitive.shape != Shape::surface) {
            distances.push_back(distance_from(primitive));
            continue;
        }
        if (!readers.surface_distance) fail_without_reader(primitive.file);
        distances.push_back(readers.surface_distance(primitive.file, choice.in_file));
    }
    return distances;
}

/// Lengths along the metric's own directions, between the limits.
Metric limited(const Metric& m, const SourcesChoice& limits) {
    const auto within = [&](double h) { return std::clamp(h, limits.h_min, limits.h_max); };
    if (is_isotropic(m)) return Metric::isotropic(within(m.xx));
    EigenFrame frame = eigen_frame(m);
    if (frame.lengths[0] >= limits.h_min && frame.lengths[2] <= limits.h_max) return m;
    for (double& h : frame.lengths) h = within(h);
    return metric_from_frame(frame.lengths, frame.directions);
}

bool has_limits(const SourcesChoice& choice) {
    return choice.h_min > 0 || choice.h_max < largest_magnitude;
}

AnalyticField limited(const AnalyticField& field, const SourcesChoice& limits) {
    const auto at = [inner = field.field, limits](const Point& p) {
        return limited(sample_at(*inner, p), limits);
    };
    return {formula_field(at, field.field->domain()),
            std::clamp(field.finest_length, limits.h_min, limits.h_max), field.places,
            field.is_isotropic};
}

/// The analytic field and the primitives together.
AnalyticField continuous_field(const SourcesChoice& choice,
                               const std::vector<DistanceField>& distances,
                               const FileReaders& readers) {
    AnalyticField field;
    if (choice.field.kind != FieldKind::none) field = field_of(choice.field, readers);
    if (!choice.primitives.empty()) {
        AnalyticField own = primitives_field(choice.primitives, distances, choice.primitives_ratio);
        if (field.field) {
            own.finest_length = std::min(own.finest_length, field.finest_length);
            own.is_isotropic = field.is_isotropic;
            own.field = mixture({field.field, own.field});
        }
        field = std::move(own);
    }
    return field.field && has_limits(choice) ? limited(field, choice) : field;
}

Box domain_of(const Study& study, const SourcesChoice& choice, std::span<const PointSource> sources,
              const Workload& workload, const std::vector<DistanceField>& distances) {
    if (study.domain) return *study.domain;
    if (workload.field.field && workload.field.field->domain() != Box::everywhere()) {
        return workload.field.field->domain();
    }
    const bool are_alone = choice.kind == SourcesKind::none && choice.field.kind == FieldKind::none;
    if (choice.kind != SourcesKind::file && !are_alone) {
        return {Point::Constant(-1), Point::Constant(1)};
    }
    std::vector<Point> positions;
    for (const PointSource& source : sources) positions.push_back(source.position);
    if (are_alone) {
        for (const DistanceField& d : distances) {
            positions.insert(positions.end(), {d.box.low, d.box.high});
        }
    }
    return bounding_box(positions, study.margin);
}

void require_inside(const SourcesChoice& choice, const std::vector<DistanceField>& distances,
                    const Box& domain) {
    for (std::size_t i = 0; i < distances.size(); ++i) {
        if (touch(distances[i].box, domain)) continue;
        refuse("{} lies outside the domain {}: enlarge the domain or drop it",
               to_string(choice.primitives[i]), to_string(domain));
    }
}

double finest_length_of(const Workload& workload) {
    if (!workload.field.field) return finest_length(workload.sources);
    if (workload.sources.empty()) return workload.field.finest_length;
    return std::min(workload.field.finest_length, finest_length(workload.sources));
}

/// In the units of the file, but for parts.
std::vector<PointSource> read_unscaled(const std::filesystem::path& file,
                                       const SourcesChoice& choice, const FileReaders& readers) {
    const std::string ending = lower_case_extension(file);
    if (const auto reader = readers.sources.find(ending); reader != readers.sources.end()) {
        return reader->second(file, choice);
    }
    if (needs_reader(ending)) fail_without_reader(file);
    if (!has_ending(own_endings, ending) && std::filesystem::is_regular_file(file)) {
        std::vector<std::string_view> all(own_endings.begin(), own_endings.end());
        for (const auto& [known, reader] : readers.sources) {
            if (!has_ending(own_endings, known)) all.push_back(known);
        }
        refuse_at(file, "its ending is none that can be read: name a {}", fmt::join(all, ", "));
    }
    return read_sources(file, {choice.in_file.array, choice.in_file.step, readers.remark});
}

std::vector<PointSource> read_one(const std::filesystem::path& file, const SourcesChoice& choice,
                                  const FileReaders& readers) {
    std::vector<PointSource> sources = read_unscaled(file, choice, readers);
    const double scale = choice.in_file.scale;
    if (scale == 1 || has_ending(part_endings(), lower_case_extension(file))) return sources;
    for (PointSource& source : sources) {
        source.position *= scale;
        source.metric = scale * source.metric;
    }
    return sources;
}

/// The sources of several files, one after the other.
struct JoinedSources {
    std::vector<PointSource> all;
    std::vector<std::size_t> of_file;  ///< how many each file has

    /// "source 17 (sources.csv, line 19)"
    std::string name(const SourcesChoice& choice, std::size_t index) const {
        std::string name = fmt::format("source {}", index);
        const auto& files = choice.files;
        for (std::size_t f = 0; f < of_file.size(); ++f) {
            if (index < of_file[f]) {
                return name + fmt::format(" ({}, {})", files[f].string(),
                                          place_of_source(files[f], index));
            }
            index -= of_file[f];
        }
        return name;
    }
};

JoinedSources read_files(const SourcesChoice& choice, const FileReaders& readers) {
    JoinedSources joined;
    for (const auto& file : choice.files) {
        auto more = read_one(file, choice, readers);
        joined.of_file.push_back(more.size());
        if (joined.all.empty()) {
            joined.all = std::move(more);  // a single file may fill the memory
        } else {
            joined.all.insert(joined.all.end(), more.begin(), more.end());
        }
    }
    return joined;
}

JoinedSources make_sources(const SourcesChoice& s, std::uint64_t seed, const FileReaders& readers) {
    switch (s.kind) {
        case SourcesKind::sphere:
            return {scatter_sphere({.centre = s.centre,
                                    .radius = s.radius,
                                    .h = s.h,
                                    .s_a = s.s_a,
                                    .s_n = s.s_n,
                                    .rho = s.rho},
                                   s.sampling, seed),
                    {}};
        case SourcesKind::planes:
            return {scatter_planes(
                        {.h = s.h, .s_a = s.s_a, .s_n = s.s_n, .rho = s.rho, .slope = s.slope},
                        s.sampling, seed),
                    {}};
        case SourcesKind::none:
            return {};
        case SourcesKind::file:
            break;
    }
    return read_files(s, readers);
}

}  // namespace

std::vector<PointSource> read_source_file(const SourcesChoice& choice, const FileReaders& readers) {
    return read_files(choice, readers).all;
}

double millimetres(LengthUnit unit) {
    constexpr std::array in_their_order{1e-3, 1.0, 10.0, 1e3, 1e6, 25.4, 304.8};
    static_assert(in_their_order.size() == static_cast<std::size_t>(LengthUnit::ft) + 1);
    return in_their_order.at(static_cast<std::size_t>(unit));
}

bool has_tensors(const Workload& workload) {
    return (workload.field.field && !workload.field.is_isotropic) ||
           !workload.sources.are_isotropic();
}

Workload make_workload(const Study& study, const SourcesChoice& choice,
                       const FileReaders& readers) {
    Workload workload;
    JoinedSources sources = make_sources(choice, study.seed, readers);
    const std::vector<DistanceField> distances = distances_of(choice, readers);
    workload.field = continuous_field(choice, distances, readers);
    workload.domain = domain_of(study, choice, sources.all, workload, distances);
    require_defined(workload.field, workload.domain, std::string(name_of(choice.field.kind)));
    require_inside(choice, distances, workload.domain);
    for (std::size_t i = 0; i < sources.all.size(); ++i) {
        PointSource& source = sources.all[i];
        if (!is_valid(source, workload.domain)) {
            require_valid(source, i, sources.name(choice, i), workload.domain);
        }
        if (has_limits(choice)) source.metric = limited(source.metric, choice);
    }
    workload.sources = columns_of(sources.all);
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
    options.h_max = c.sources.h_max;
    options.ratio = c.g_r;
    options.max_bytes = static_cast<std::size_t>(std::ceil(study.max_memory_gib * gib));
    if (c.split) options.split = *c.split;
    if (c.max_depth) (c.split ? options.kd_depth : options.octree_depth) = *c.max_depth;
    options.voxel = c.voxel.value_or(0);
    options.prune_delta = c.prune_delta.value_or(0);
    if (c.interpolation) options.quadratic_form = *c.interpolation;
    options.intersection = c.intersection;
    options.vertices_in_turn =
        c.schedule != GradationSchedule::sources || c.law != GradationLaw::cone;
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
            return exact_reference(workload.sources, c.g_r,
                                   largest_metric(workload.domain, c.sources.h_max),
                                   study.reference_tolerance, c.intersection, workload.field.field);
        }};
    return exact;
}

ReferenceProbes make_reference_probes(const Study& study, const Case& c, const Workload& workload) {
    const auto field = make_reference(study, c, workload);
    const Box& domain = workload.domain;
    const std::size_t n = study.access_points;
    ReferenceProbes probes{make_probes(*field, cell_centres(domain, study.probe_grid)),
                           make_probes(*field, cell_centres(domain, study.fine_probe_grid)),
                           {},
                           {}};
    probes.near =
        workload.sources.empty()
            ? places_where_fine(probes.fine, study.fine_probe_grid, domain, n, study.seed + 1)
            : places_near(workload.sources, domain, n, study.seed + 1);
    probes.walk = walks(*field, domain, probes.near, n, study.seed + 2);
    return probes;
}

}  // namespace controlspace
