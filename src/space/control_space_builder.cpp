// SPDX-License-Identifier: Apache-2.0
#include "controlspace/space/control_space_builder.h"

#include <fmt/format.h>

#include "controlspace/input_errors.h"
#include "controlspace/space/sample_parallel.h"
#include "space/goal_field.h"

namespace controlspace {

Insertion ControlSpaceBuilder::insert(const PointSource& source) {
    return insert(std::span(&source, 1)).inserted > 0 ? Insertion::inserted
                                                      : Insertion::already_met;
}

InsertionReport ControlSpaceBuilder::insert(const SourceColumns& sources) {
    require_valid(sources, domain());
    InsertionReport report;
    for_each_part(sources, [&](std::span<const PointSource> part) { report += insert(part); });
    return report;
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
    if (!report.met) report.shortfall = "nodes stay where they are: more are needed";
    return report;
}

void require_valid(const PointSource& source, std::size_t index, const Box& domain) {
    if (!is_valid(source, domain)) {
        require_valid(source, index, fmt::format("source {}", index), domain);
    }
}

void require_valid(const PointSource& source, std::size_t index, const std::string& name,
                   const Box& domain) {
    const auto require = [&](bool holds, const std::string& what) {
        if (!holds) throw IndexedError(index, name + what);
    };
    const Point& p = source.position;
    require(
        domain.contains(p),
        fmt::format(" at ({}, {}, {}) lies outside the domain {}: enlarge the domain or drop it",
                    p.x(), p.y(), p.z(), to_string(domain)));
    require(is_positive_definite(source.metric),
            fmt::format(" has the metric {} (xx yy zz xy xz yz), which is not positive definite",
                        to_string(source.metric)));
    require(is_source_metric(source.metric),
            fmt::format(" has the metric {} (xx yy zz xy xz yz), with lengths beyond {} to {}: use "
                        "another unit of length",
                        to_string(source.metric), 1 / largest_magnitude, largest_magnitude));
    require(is_source_growth(source.growth),
            fmt::format(" has the gradation ratio {}: give one from 1 to 1e6, or 0 for that of the "
                        "field",
                        source.growth));
}

void require_valid(const SourceColumns& sources, const Box& domain) {
    for (std::size_t i = 0; i < sources.size(); ++i) require_valid(sources[i], i, domain);
}

bool is_valid(const PointSource& source, const Box& domain) {
    const Metric& m = source.metric;
    const bool is_metric = (is_isotropic(m) && is_length(m.xx)) || is_source_metric(m);
    return is_metric && is_source_growth(source.growth) && domain.contains(source.position);
}

void refuse_precision() {
    throw InputError("this structure has no choice of precision: build it as it is made");
}

void require_one_each(std::size_t metrics, std::size_t control_nodes) {
    if (metrics == control_nodes) return;
    throw InputError(
        fmt::format("{} metrics for {} control nodes: give one for each", metrics, control_nodes));
}

}  // namespace controlspace
