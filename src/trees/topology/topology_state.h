// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <atomic>
#include <span>
#include <vector>

#include "space/state.h"
#include "trees/topology/topology.h"
#include "trees/topology/work_through.h"

namespace controlspace {

/// Writes the inner nodes of a tree; they say all about it but its domain.
template <class Node>
void save(const Topology<Node>& tree, StateWriter& state) {
    std::vector<std::uint32_t> children;
    std::vector<double> planes;
    children.reserve(tree.inner_nodes() * Node::arity);
    for (const Node& node : tree.nodes()) {
        for (const Ref child : node.children) children.push_back(child.bits());
        const auto at = node.planes();
        planes.insert(planes.end(), at.begin(), at.end());
    }
    state("tree.children", children);
    state("tree.planes", planes);
}

/// Whether nodes make a tree: each but the first is the child of one before it, each leaf is there
/// once, and none is deeper than any tree may be.
template <class Node>
bool is_tree(std::span<const Node> nodes) {
    constexpr std::uint8_t deepest = 200;
    std::size_t leaves = 1;
    for (const Node& node : nodes) leaves += static_cast<std::size_t>(node.count() - 1);
    std::vector<std::uint8_t> level(nodes.size(), 0);
    std::vector<bool> has_leaf(leaves, false);
    for (std::size_t i = 0; i < nodes.size(); ++i) {
        if ((i > 0) == (level[i] == 0)) return false;
        if constexpr (requires { nodes[i].axis(); }) {
            if (nodes[i].axis() > 2) return false;
        }
        for (int k = 0; k < nodes[i].count(); ++k) {
            const Ref child = nodes[i].children[nodes[i].slot(k)];
            const std::size_t c = child.index();
            if (child.is_leaf()) {
                if (c >= leaves || has_leaf[c]) return false;
                has_leaf[c] = true;
            } else {
                if (c <= i || c >= nodes.size() || level[c] != 0 || level[i] == deepest) {
                    return false;
                }
                level[c] = static_cast<std::uint8_t>(level[i] + 1);
            }
        }
    }
    return true;
}

/// Whether each node's planes stand inside of its box, across the axes that its level may cut.
template <class Node>
bool cuts_properly(const Topology<Node>& tree) {
    struct Part {
        Ref ref;
        int level;
        Box box;
    };
    std::atomic<bool> properly = true;
    work_through(Part{tree.root(), 0, tree.domain()}, [&](const Part& part, auto&& next) {
        if (part.ref.is_leaf()) return;
        const Node& node = tree.node(part.ref);
        const Subdivision subdivision = node.subdivision(part.box);
        if (!Node::may_cut(tree.domain(), part.level, subdivision) || !subdivision.is_proper()) {
            properly = false;
            return;
        }
        for (int c = 0; c < subdivision.children(); ++c) {
            const Ref child = node.children[node.slot(c)];
            if (child.is_leaf()) continue;
            __builtin_prefetch(&tree.node(child));
            next(Part{child, part.level + 1, subdivision.child(c)});
        }
    });
    return properly;
}

/// The tree that `save` has written, with the same numbers of leaves. Throws InputError.
template <class Node>
Topology<Node> load_topology(const Box& domain, const StateReader& state) {
    std::vector<std::uint32_t> children;
    std::vector<double> planes;
    state("tree.children", children);
    state("tree.planes", planes);
    std::vector<Node> nodes(children.size() / Node::arity);
    const bool fits = children.size() == nodes.size() * Node::arity &&
                      planes.size() == nodes.size() * Node().planes().size() &&
                      children.size() <= Ref::max_index;
    state.require(fits, "tree", "has nodes without children or planes");
    auto child = children.begin();
    auto plane = planes.begin();
    for (Node& node : nodes) {
        for (Ref& ref : node.children) ref = Ref::from_bits(*child++);
        for (double& at : node.planes()) at = *plane++;
    }
    state.require(is_tree(std::span<const Node>(nodes)), "tree", "is no tree");
    Topology<Node> tree(domain, std::move(nodes));
    state.require(cuts_properly(tree), "tree", "has planes out of place");
    return tree;
}

}  // namespace controlspace
