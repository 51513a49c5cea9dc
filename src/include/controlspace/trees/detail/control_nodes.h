// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tbb/combinable.h>

#include <algorithm>
#include <numeric>
#include <span>
#include <utility>
#include <vector>

#include "controlspace/geometry/detail/large_pages.h"
#include "controlspace/gradation/grade.h"
#include "controlspace/gradation/law.h"
#include "controlspace/space/control_space_builder.h"
#include "controlspace/space/detail/given_sources.h"
#include "controlspace/space/detail/goal_field.h"
#include "controlspace/trees/detail/in_parallel.h"
#include "controlspace/trees/detail/leaf_graph.h"
#include "controlspace/trees/detail/nearby_field.h"
#include "controlspace/trees/storage.h"

namespace controlspace {

// What is done with the control nodes of a tree, wherever they stand: once for all storages.

/// The control nodes as a graph, and which node of the storage each of the graph's is; without an
/// order they are numbered alike.
template <class Node, class Storage>
LeafGraph ordered_nodes(const Topology<Node>& tree, const Storage& storage,
                        Neighbourhood neighbourhood) {
    if constexpr (nodes_per_leaf<Storage> == 1) {
        return leaf_graph(tree, neighbourhood);
    } else {
        return {vertex_graph(storage.corners(), storage.positions(), neighbourhood), {}};
    }
}

template <class Node, class Storage>
ControlNodes nodes_of_tree(const Topology<Node>& tree, const Storage& storage,
                           Neighbourhood neighbourhood) {
    LeafGraph nodes = ordered_nodes(tree, storage, neighbourhood);
    const std::span<const Metric> field = storage.metrics().field();
    std::vector<Metric> metrics(field.begin(), field.end());
    for (std::size_t i = 0; i < nodes.order.size(); ++i) metrics[i] = field[nodes.order[i]];
    return {std::move(nodes.graph), std::move(metrics)};
}

/// The largest gradation ratio of the control nodes. Leaves across faces are not listed as a graph,
/// which takes twice the memory of the metrics.
template <class Node, class Storage>
double largest_gradation_of_tree(const Topology<Node>& tree, const Storage& storage,
                                 Neighbourhood neighbourhood, GradationLaw law) {
    if constexpr (nodes_per_leaf<Storage> == 1) {
        if (neighbourhood == Neighbourhood::faces) {
            std::vector<Point> centres = large_array<Point>(tree.leaves());
            tree.for_each_leaf(
                [&](LeafIndex leaf, const Box& box) { centres[leaf] = box.centre(); });
            const std::span<const Metric> metrics = storage.metrics().field();
            tbb::combinable<double> largest([] { return 1.0; });
            for_each_face_pair(tree, parts_of(tree), [&](LeafIndex a, LeafIndex b) {
                double& own = largest.local();
                const Vector v = centres[b] - centres[a];
                own = std::max({own, gradation_between(law, metrics[a], metrics[b], v),
                                gradation_between(law, metrics[b], metrics[a], -v)});
            });
            return largest.combine([](double a, double b) { return std::max(a, b); });
        }
    }
    const ControlNodes nodes = nodes_of_tree(tree, storage, neighbourhood);
    return largest_gradation(nodes.graph, nodes.metrics, law);
}

/// Throws InputError for a wrong number.
template <class Node, class Storage>
void assign_nodes(const Topology<Node>& tree, Storage& storage, std::span<const Metric> metrics) {
    NodeMetrics& own = storage.metrics();
    require_one_each(metrics.size(), own.size());
    if constexpr (nodes_per_leaf<Storage> == 1) {
        auto next = metrics.begin();
        tree.for_each_leaf([&](LeafIndex leaf, const Box&) { own.set(leaf, *next++); });
    } else {
        for (std::size_t i = 0; i < metrics.size(); ++i) own.set(i, metrics[i]);
    }
    if constexpr (requires { storage.assigned(); }) storage.assigned();
}

/// Intersects the control nodes with the field.
template <class Node, class Storage>
GradationReport grade_nodes_to(const ControlSpace& field, const Topology<Node>& tree,
                               Storage& storage) {
    const std::span<Metric> metrics = storage.metrics().field();
    if constexpr (nodes_per_leaf<Storage> == 1) {
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
    } else {
        return grade_to(field, storage.positions(), metrics);
    }
}

template <class Node, class Storage>
GradationReport grade_nodes(const Topology<Node>& tree, Storage& storage,
                            const NodeGradation& gradation) {
    const GradationOptions& options = gradation.options;
    GradationReport report;
    if (gradation.field) {
        report = grade_nodes_to(*gradation.field, tree, storage);
    } else {
        LeafGraph nodes = ordered_nodes(tree, storage, neighbourhood_of(options));
        report = grade(std::move(nodes.graph), {storage.metrics().field(), nodes.order}, options);
    }
    if constexpr (requires { storage.graded(options.ratio); }) {
        storage.graded(gradation.largest_ratio);
    }
    if constexpr (requires { storage.prepare(tree); }) storage.prepare(tree);
    return report;
}

/// Intersects the metrics of a leaf's nodes with a source's.
template <class Storage>
void lower_nodes(Storage& storage, const LeafPlace& place, const Metric& metric) {
    if constexpr (requires { storage.lower(place, metric); }) {
        storage.lower(place, metric);
    } else {
        for (const NodeIndex node : storage.nodes_of(place.leaf)) {
            storage.metrics().lower(node, metric);
        }
    }
}

/// Sets the control nodes of these leaves to the field.
template <class Storage>
void fit_nodes(Storage& storage, std::span<const LeafBox> leaves, const GoalField& field) {
    std::vector<std::pair<NodeIndex, Point>> nodes;
    nodes.reserve(nodes_per_leaf<Storage> * leaves.size());
    for (const LeafBox& l : leaves) {
        for (const NodeIndex node : storage.nodes_of(l.leaf)) {
            if constexpr (nodes_per_leaf<Storage> == 1) {
                nodes.emplace_back(node, l.box.centre());
            } else {
                nodes.emplace_back(node, storage.positions()[node]);
            }
        }
    }
    if constexpr (has_vertices<Storage>) {
        const auto number = [](const auto& node) { return node.first; };
        std::ranges::sort(nodes, {}, number);
        const auto repeated = std::ranges::unique(nodes, {}, number);
        nodes.erase(repeated.begin(), repeated.end());
    }
    in_parallel(nodes.size(), [&, nearby = NearbyField(field)](std::size_t i) mutable {
        storage.metrics().set(nodes[i].first, nearby.at(nodes[i].second));
    });
}

}  // namespace controlspace
