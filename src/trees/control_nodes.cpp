// SPDX-License-Identifier: Apache-2.0
#include "trees/control_nodes.h"

#include <tbb/combinable.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "controlspace/space/control_space_builder.h"
#include "geometry/large_pages.h"
#include "trees/topology/leaf_graph.h"

namespace controlspace {

namespace {

template <class Node>
bool are_leaves(const LeafModel<Node>& model) {
    return model.corners().empty();
}

// The control nodes as a graph, and which node of the model each of the graph's is; without an
// order they are numbered alike.
template <class Node>
LeafGraph ordered_nodes(const Topology<Node>& tree, const LeafModel<Node>& model,
                        Neighbourhood neighbourhood) {
    if (are_leaves(model)) return leaf_graph(tree, neighbourhood);
    const auto x = model.positions();
    return {vertex_graph(model.corners(), {x.begin(), x.end()}, neighbourhood), {}};
}

// Intersects the control nodes with the field.
template <class Node>
GradationReport grade_nodes_to(const ControlSpace& field, const Topology<Node>& tree,
                               LeafModel<Node>& model) {
    const std::span<Metric> metrics = model.metrics().field();
    if (!are_leaves(model)) return grade_to(field, model.positions(), metrics);
    // Some at a time: in all they would take half as much memory as the metrics.
    constexpr std::size_t most = std::size_t{1} << 16;
    GradationReport report;
    std::vector<Point> x;
    std::vector<LeafIndex> order;
    x.reserve(std::min(most, tree.leaves()));
    order.reserve(std::min(most, tree.leaves()));
    std::size_t left = tree.leaves();
    tree.for_each_leaf([&](LeafIndex leaf, const Box& box) {
        x.push_back(box.centre());
        order.push_back(leaf);
        if (--left > 0 && x.size() < most) return;
        report.operations += grade_to(field, x, {metrics, order}).operations;
        x.clear();
        order.clear();
    });
    return report;
}

}  // namespace

template <class Node>
ControlNodes nodes_of_tree(const Topology<Node>& tree, const LeafModel<Node>& model,
                           Neighbourhood neighbourhood) {
    LeafGraph nodes = ordered_nodes(tree, model, neighbourhood);
    const std::span<const Metric> field = model.metrics().field();
    std::vector<Metric> metrics(field.begin(), field.end());
    for (std::size_t i = 0; i < nodes.order.size(); ++i) metrics[i] = field[nodes.order[i]];
    return {std::move(nodes.graph), std::move(metrics)};
}

// Leaves across faces are not listed as a graph, which takes twice the memory of the metrics.
template <class Node>
double largest_gradation_of_tree(const Topology<Node>& tree, const LeafModel<Node>& model,
                                 Neighbourhood neighbourhood, GradationLaw law) {
    if (!are_leaves(model) || neighbourhood != Neighbourhood::faces) {
        const ControlNodes nodes = nodes_of_tree(tree, model, neighbourhood);
        return largest_gradation(nodes.graph, nodes.metrics, law);
    }
    std::vector<Point> centres = large_array<Point>(tree.leaves());
    tree.for_each_leaf([&](LeafIndex leaf, const Box& box) { centres[leaf] = box.centre(); });
    const std::span<const Metric> metrics = model.metrics().field();
    tbb::combinable<double> largest([] { return 1.0; });
    for_each_face_pair(tree, parts_of(tree), [&](LeafIndex a, LeafIndex b) {
        double& of_thread = largest.local();
        const Vector v = centres[b] - centres[a];
        of_thread = std::max({of_thread, gradation_between(law, metrics[a], metrics[b], v),
                              gradation_between(law, metrics[b], metrics[a], -v)});
    });
    return largest.combine([](double a, double b) { return std::max(a, b); });
}

template <class Node>
void assign_nodes(const Topology<Node>& tree, LeafModel<Node>& model,
                  std::span<const Metric> metrics) {
    NodeMetrics& nodes = model.metrics();
    require_one_each(metrics.size(), nodes.size());
    if (are_leaves(model)) {
        auto next = metrics.begin();
        tree.for_each_leaf([&](LeafIndex leaf, const Box&) { nodes.set(leaf, *next++); });
    } else {
        for (std::size_t i = 0; i < metrics.size(); ++i) nodes.set(i, metrics[i]);
    }
    model.assigned();
}

template <class Node>
GradationReport grade_nodes(const Topology<Node>& tree, LeafModel<Node>& model,
                            const NodeGradation& gradation) {
    const GradationOptions& options = gradation.options;
    GradationReport report;
    if (gradation.field) {
        report = grade_nodes_to(*gradation.field, tree, model);
    } else {
        LeafGraph nodes = ordered_nodes(tree, model, neighbourhood_of(options));
        report = grade(std::move(nodes.graph), {model.metrics().field(), nodes.order}, options);
    }
    model.graded(gradation.largest_ratio);
    model.prepare(tree);
    return report;
}

template ControlNodes nodes_of_tree(const Topology<KdNode>&, const LeafModel<KdNode>&,
                                    Neighbourhood);
template ControlNodes nodes_of_tree(const Topology<OctreeNode>&, const LeafModel<OctreeNode>&,
                                    Neighbourhood);
template double largest_gradation_of_tree(const Topology<KdNode>&, const LeafModel<KdNode>&,
                                          Neighbourhood, GradationLaw);
template double largest_gradation_of_tree(const Topology<OctreeNode>&, const LeafModel<OctreeNode>&,
                                          Neighbourhood, GradationLaw);
template void assign_nodes(const Topology<KdNode>&, LeafModel<KdNode>&, std::span<const Metric>);
template void assign_nodes(const Topology<OctreeNode>&, LeafModel<OctreeNode>&,
                           std::span<const Metric>);
template GradationReport grade_nodes(const Topology<KdNode>&, LeafModel<KdNode>&,
                                     const NodeGradation&);
template GradationReport grade_nodes(const Topology<OctreeNode>&, LeafModel<OctreeNode>&,
                                     const NodeGradation&);

}  // namespace controlspace
