#include "trees/packing/frozen_state.h"

#include <cmath>
#include <vector>

#include "trees/packing/frozen_tree.h"
#include "trees/topology/corners.h"
#include "trees/topology/topology.h"
#include "trees/topology/topology_state.h"

namespace controlspace {

namespace {

// What was saved has its order already, so freezing it again keeps it; floats that were widened
// are rounded back to themselves.
template <class Node>
std::unique_ptr<ControlSpace> load_frozen(FrozenKind kind, const Box& domain, Precision precision,
                                          const StateReader& state) {
    const auto tree = load_topology<Node>(domain, state);
    std::vector<Metric> metrics;
    state("frozen.metrics", metrics);
    require_metrics(state, "frozen.metrics", metrics);
    if (kind == FrozenKind::vertices) {
        std::vector<Corners> corners;
        state("frozen.corners", corners);
        state.require(corners.size() == tree.leaves(), "frozen.corners", "are not of these leaves");
        require_below(state, "frozen.corners", corners, metrics.size());
        return freeze_vertices(tree, corners, metrics, precision);
    }
    state.require(metrics.size() == tree.leaves(), "frozen.metrics", "are not of these leaves");
    if (kind == FrozenKind::leaves) return freeze_leaves(tree, metrics, precision);
    QuadraticRule rule;
    state("frozen.slope", rule.slope);
    state("frozen.form", rule.form, QuadraticForm::published);
    state.require(std::isfinite(rule.slope) && rule.slope >= 0, "frozen.slope", "is no slope");
    return freeze_quadratic(tree, metrics, rule, precision);
}

}  // namespace

std::unique_ptr<ControlSpace> load_frozen(const Box& domain, Precision precision,
                                          const StateReader& state) {
    bool is_octree = false;
    FrozenKind kind{};
    state("frozen.is_octree", is_octree);
    state("frozen.kind", kind, FrozenKind::vertices);
    return is_octree ? load_frozen<OctreeNode>(kind, domain, precision, state)
                     : load_frozen<KdNode>(kind, domain, precision, state);
}

}  // namespace controlspace
