#include "controlspace/space/control_space.h"

#include <fmt/format.h>

#include <cmath>

#include "controlspace/error.h"
#include "trees/adaptation/goal_field.h"

namespace controlspace {

Metric sample_at(const ControlSpace& space, const Point& x) {
    Metric m;
    space.sample({&x, 1}, {&m, 1});
    return m;
}

GradationReport ControlSpace::grade(const GradationOptions& options) {
    ControlNodes nodes = control_nodes(neighbourhood_of(options));
    const GradationReport report = controlspace::grade(nodes.graph, nodes.metrics, options);
    assign(nodes.metrics);
    return report;
}

void ControlSpace::save(StateWriter&) const {
    throw InputError("this structure cannot be saved: choose one of the catalogue");
}

void ControlSpace::load(const StateReader&) {
    throw InputError("this structure cannot be loaded: choose one of the catalogue");
}

AdaptationReport ControlSpace::adapt(const AdaptationGoal& goal) {
    const GoalField field(goal, domain());
    ControlNodes nodes = control_nodes(Neighbourhood::faces);
    field.evaluate(positions(nodes.graph), nodes.metrics);
    assign(nodes.metrics);
    AdaptationReport report;
    report.reached = field.largest_departure(*this);
    report.met = report.reached <= goal.target;
    if (!report.met) report.shortfall = "a grid keeps its voxels: make them smaller";
    return report;
}

std::unique_ptr<ControlSpace> ControlSpace::freeze(Precision) const {
    throw InputError("this structure cannot be frozen: choose a tree that holds metrics");
}

void require_valid(const PointSource& source, std::size_t index, const Box& domain) {
    if (!domain.contains(source.position)) {
        throw InputError(fmt::format(
            "source {} at ({}, {}, {}) lies outside the domain {}: enlarge the domain or drop it",
            index, source.position.x(), source.position.y(), source.position.z(),
            to_string(domain)));
    }
    if (!is_positive_definite(source.metric)) {
        throw InputError(fmt::format(
            "source {} has the metric {} (xx yy zz xy xz yz), which is not positive definite",
            index, to_string(source.metric)));
    }
}

bool is_valid(const PointSource& source, const Box& domain) {
    const Metric& m = source.metric;
    const bool is_metric =
        is_isotropic(m) ? m.xx > 0 && std::isfinite(m.xx) : is_positive_definite(m);
    return is_metric && domain.contains(source.position);
}

}  // namespace controlspace
