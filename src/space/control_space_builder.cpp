#include "controlspace/space/control_space_builder.h"

#include <fmt/format.h>

#include <cmath>

#include "controlspace/error.h"
#include "controlspace/space/detail/goal_field.h"
#include "controlspace/space/sample_parallel.h"

namespace controlspace {

Insertion ControlSpaceBuilder::insert(const PointSource& source) {
    return insert(std::span(&source, 1)).inserted > 0 ? Insertion::inserted
                                                      : Insertion::already_met;
}

GradationReport NodeBuilder::grade(const GradationOptions& options) {
    ControlNodes nodes = control_nodes(neighbourhood_of(options));
    const GradationReport report = controlspace::grade(nodes.graph, nodes.metrics, options);
    assign(nodes.metrics);
    return report;
}

AdaptationReport NodeBuilder::adapt(const AdaptationGoal& goal) {
    const GoalField field(goal, domain());
    ControlNodes nodes = control_nodes(Neighbourhood::faces);
    sample_parallel(field, positions(nodes.graph), nodes.metrics);
    assign(nodes.metrics);
    AdaptationReport report;
    const auto space = build();
    report.reached =
        field.largest_departure(domain(), [&](auto x, auto metrics) { space->sample(x, metrics); });
    report.met = report.reached <= goal.target;
    if (!report.met) report.shortfall = "a grid keeps its voxels: make them smaller";
    return report;
}

void require_valid(const PointSource& source, std::size_t index, const Box& domain) {
    if (!is_valid(source, domain)) require_valid(source, fmt::format("source {}", index), domain);
}

void require_valid(const PointSource& source, const std::string& name, const Box& domain) {
    if (!domain.contains(source.position)) {
        throw InputError(fmt::format(
            "{} at ({}, {}, {}) lies outside the domain {}: enlarge the domain or drop it", name,
            source.position.x(), source.position.y(), source.position.z(), to_string(domain)));
    }
    if (!is_positive_definite(source.metric)) {
        throw InputError(
            fmt::format("{} has the metric {} (xx yy zz xy xz yz), which is not positive definite",
                        name, to_string(source.metric)));
    }
}

bool is_valid(const PointSource& source, const Box& domain) {
    const Metric& m = source.metric;
    const bool is_metric =
        is_isotropic(m) ? m.xx > 0 && std::isfinite(m.xx) : is_positive_definite(m);
    return is_metric && domain.contains(source.position);
}

void require_one_each(std::size_t metrics, std::size_t control_nodes) {
    if (metrics == control_nodes) return;
    throw InputError(
        fmt::format("{} metrics for {} control nodes: give one for each", metrics, control_nodes));
}

}  // namespace controlspace
