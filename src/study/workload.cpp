#include "study/workload.h"

#include "measure/reference.h"
#include "sources/read_sources.h"
#include "sources/sampled_surfaces.h"
#include "spaces/control_space.h"

namespace controlspace {
namespace {

std::vector<PointSource> make_sources(const SourcesChoice& s) {
    switch (s.kind) {
        case SourcesKind::sphere:
            return sample_sphere(
                {.radius = s.radius, .h = s.h, .s_a = s.s_a, .s_n = s.s_n, .rho = s.rho});
        case SourcesKind::planes:
            return sample_planes(
                {.h = s.h, .s_a = s.s_a, .s_n = s.s_n, .rho = s.rho, .slope = s.slope});
        case SourcesKind::file:
            break;
    }
    return read_sources(s.file);
}

Box domain_of(const Study& study, const std::vector<PointSource>& sources) {
    if (study.domain) return *study.domain;
    if (is_sampled(study.sources)) return {Point::Constant(-1), Point::Constant(1)};
    std::vector<Point> positions;
    positions.reserve(sources.size());
    for (const PointSource& source : sources) positions.push_back(source.position);
    return bounding_box(positions, study.margin);
}

std::shared_ptr<const MetricField> make_reference(const Case& c, const Workload& workload) {
    const double largest = workload.domain.half_diagonal();
    if (c.reference == ReferenceKind::published_sphere) {
        const SourcesChoice& s = c.sources;
        return published_sphere_reference(s.radius, s.h * s.s_a, c.g_r, largest);
    }
    return exact_reference(workload.sources, c.g_r, Metric::isotropic(largest));
}

}  // namespace

Workload make_workload(const Study& study, const SourcesChoice& choice) {
    Workload workload;
    workload.sources = make_sources(choice);
    workload.domain = domain_of(study, workload.sources);
    for (std::size_t i = 0; i < workload.sources.size(); ++i) {
        require_valid(workload.sources[i], i, workload.domain);
    }
    workload.finest_length = finest_length(workload.sources);
    return workload;
}

SpaceOptions space_options(const Study& study, const Case& c, const Workload& workload) {
    constexpr double gib = 1024.0 * 1024 * 1024;
    SpaceOptions options;
    options.domain = workload.domain;
    options.l_min = c.tau;
    options.tolerance = c.epsilon;
    options.finest_length = workload.finest_length;
    options.ratio = c.g_r;
    options.max_bytes = static_cast<std::size_t>(study.max_memory_gib * gib);
    if (c.split) options.split = *c.split;
    if (c.max_depth) (c.split ? options.kd_depth : options.octree_depth) = *c.max_depth;
    options.voxel = c.voxel.value_or(0);
    if (c.voxel_factor) options.voxel_factor = *c.voxel_factor;
    options.prune_delta = c.prune_delta.value_or(0);
    require_valid(options);
    return options;
}

ReferenceProbes make_reference_probes(const Study& study, const Case& c, const Workload& workload) {
    const auto field = make_reference(c, workload);
    return {make_probes(*field, cell_centres(workload.domain, study.probe_grid)),
            make_probes(*field, cell_centres(workload.domain, study.fine_probe_grid))};
}

}  // namespace controlspace
