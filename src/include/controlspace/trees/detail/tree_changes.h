// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <type_traits>
#include <unordered_set>
#include <vector>

#include "controlspace/gradation/detail/regrade.h"
#include "controlspace/space/detail/state.h"
#include "controlspace/trees/detail/corners.h"
#include "controlspace/trees/detail/leaves_where.h"
#include "controlspace/trees/storage.h"
#include "controlspace/trees/topology.h"

namespace controlspace {

/// The control nodes of a tree for Regradation. A node at the centre of a leaf is named by the leaf
/// and its box, one at a vertex by its number.
template <class TreeNode, class Storage>
class RegradedNodes {
public:
    static constexpr bool at_vertices = has_vertices<Storage>;
    using Node = std::conditional_t<at_vertices, NodeIndex, LeafBox>;

    RegradedNodes(const Topology<TreeNode>& tree, Storage& storage, Neighbourhood neighbourhood)
        : tree_(tree), storage_(storage), neighbourhood_(neighbourhood) {}

    double requested(const Node& node) const {
        return storage_.metrics().requested()[number(node)].xx;
    }
    double field(const Node& node) const { return storage_.metrics()[number(node)].xx; }
    void set(const Node& node, double h) {
        storage_.metrics().set(number(node), Metric::isotropic(h));
    }
    Vector way(const Node& from, const Node& to) const { return position(to) - position(from); }

    /// Vertices that share several leaves with the node come as often.
    template <class Visit>
    void for_each_link(const Node& node, Visit&& visit) const {
        if constexpr (at_vertices) {
            for_each_leaf_at(tree_, position(node), [&](LeafIndex leaf, const Box&) {
                const Corners& corners = storage_.nodes_of(leaf);
                for (std::size_t i = 0; i < 8; ++i) {
                    if (corners[i] != node) continue;
                    for (std::size_t j = 0; j < 8; ++j) {
                        if (corners[j] == node || !are_neighbours(i, j, neighbourhood_)) continue;
                        visit(corners[j], way(node, corners[j]));
                    }
                }
            });
        } else {
            for_each_leaf_around(tree_, node.box, neighbourhood_,
                                 [&](LeafIndex leaf, const Box& box) {
                                     const Node other{leaf, box};
                                     if (leaf != node.leaf) visit(other, way(node, other));
                                 });
        }
    }

    static NodeIndex number(const Node& node) {
        if constexpr (at_vertices) {
            return node;
        } else {
            return node.leaf;
        }
    }
    Point position(const Node& node) const {
        if constexpr (at_vertices) {
            return storage_.positions()[node];
        } else {
            return node.box.centre();
        }
    }

private:
    const Topology<TreeNode>& tree_;
    Storage& storage_;
    Neighbourhood neighbourhood_;
};

/// Incremental gradation of a tree: which leaves were cut and which nodes were lowered since the
/// last gradation, and the gradation of these and of what depends on them.
template <class Storage>
class TreeChanges {
    static constexpr bool at_vertices = has_vertices<Storage>;

public:
    void begin(std::size_t leaves, std::size_t nodes) {
        *this = {};
        leaves_ = leaves;
        nodes_ = nodes;
    }
    /// The leaf is about to be cut. The number of a leaf that was cut is that of its first child.
    void before_split(const Storage& storage, const Subdivision& subdivision, LeafIndex leaf) {
        if (leaf >= leaves_ || !is_cut_.insert(leaf).second) return;
        cut_leaves_.push_back(leaf);
        cut_boxes_.push_back(subdivision.box);
        if constexpr (at_vertices) {
            cut_.push_back(storage.nodes_of(leaf));
        } else {
            cut_.push_back(storage.metrics()[leaf].xx);
        }
    }
    /// The nodes of the leaf were lowered.
    void lower(const Storage& storage, const LeafPlace& place) {
        for (const NodeIndex node : storage.nodes_of(place.leaf)) {
            if (!is_old(node) || !is_lowered_.insert(node).second) continue;
            lowered_.push_back(node);
            if constexpr (!at_vertices) lowered_boxes_.push_back(place.box);
        }
    }
    /// Number of changes; the tree now has so many leaves.
    std::size_t count(std::size_t leaves) const { return lowered_.size() + leaves - leaves_; }

    void save(StateWriter& state) const { exchange(*this, state); }
    /// What was saved of a tree of so many leaves and nodes. Throws InputError.
    void load(const StateReader& state, std::size_t leaves, std::size_t nodes) {
        exchange(*this, state);
        state.require(leaves_ <= leaves && nodes_ <= nodes, "changes.leaves", "is out of range");
        state.require(cut_boxes_.size() == cut_leaves_.size() &&
                          cut_.size() == cut_leaves_.size() &&
                          lowered_boxes_.size() == (at_vertices ? 0 : lowered_.size()),
                      "changes", "have arrays of different lengths");
        require_below(state, "changes.cut_leaves", cut_leaves_, leaves);
        require_below(state, "changes.lowered", lowered_, nodes);
        if constexpr (at_vertices) require_below(state, "changes.cut", cut_, nodes);
        is_cut_ = {cut_leaves_.begin(), cut_leaves_.end()};
        is_lowered_ = {lowered_.begin(), lowered_.end()};
    }

    /// See Regradation; `past` is the gradation before.
    template <class TreeNode>
    GradationReport regrade(const Topology<TreeNode>& tree, Storage& storage,
                            const PastGradation& past) const {
        const Neighbourhood neighbourhood = neighbourhood_of(past.options);
        using Nodes = RegradedNodes<TreeNode, Storage>;
        Nodes nodes(tree, storage, neighbourhood);
        Regradation regradation(nodes, past.options.ratio);
        std::vector<typename Nodes::Node> fresh, touched, doubtful;
        for (std::size_t k = 0; k < cut_.size(); ++k) {
            const Box& cut = cut_boxes_[k];
            if constexpr (at_vertices) {
                const auto doubt = [&](NodeIndex held, NodeIndex by) {
                    if (regradation.may_depend_on(held, nodes.field(by), nodes.way(by, held))) {
                        doubtful.push_back(held);
                    }
                };
                for_each_pair(cut_[k], neighbourhood, [&](NodeIndex a, NodeIndex b) {
                    doubt(a, b);
                    doubt(b, a);
                });
            }
            for_each_leaf_around(tree, cut, neighbourhood, [&](LeafIndex leaf, const Box& box) {
                const bool is_new = cut.contains(box.centre());
                if constexpr (at_vertices) {
                    for (const NodeIndex node : storage.nodes_of(leaf)) {
                        if (is_new) (node < nodes_ ? touched : fresh).push_back(node);
                    }
                } else if (const LeafBox node{leaf, box}; is_new) {
                    fresh.push_back(node);
                } else if (regradation.may_depend_on(node, cut_[k],
                                                     Vector(box.centre() - cut.centre()))) {
                    doubtful.push_back(node);
                }
            });
        }
        for (std::size_t k = 0; k < lowered_.size(); ++k) {
            if (!is_old(lowered_[k])) continue;
            if constexpr (at_vertices) {
                touched.push_back(lowered_[k]);
            } else {
                touched.push_back({lowered_[k], lowered_boxes_[k]});
            }
        }
        if constexpr (at_vertices) {
            for (auto* some : {&fresh, &touched}) {
                std::ranges::sort(*some);
                const auto repeated = std::ranges::unique(*some);
                some->erase(repeated.begin(), repeated.end());
            }
        }
        for (const auto& node : fresh) regradation.renew(node);
        for (const auto& node : doubtful) regradation.release(node);
        for (const auto& node : touched) regradation.touch(node);
        return regradation.run(past.largest_ratio_left);
    }

private:
    // A node as the last gradation left it, but for its metric.
    bool is_old(NodeIndex node) const {
        if constexpr (at_vertices) {
            return node < nodes_;
        } else {
            return node < leaves_ && !is_cut_.contains(node);
        }
    }
    template <class Self, class State>
    static void exchange(Self& self, State& state) {
        state("changes.leaves", self.leaves_);
        state("changes.nodes", self.nodes_);
        state("changes.cut_leaves", self.cut_leaves_);
        state("changes.cut_boxes", self.cut_boxes_);
        state("changes.cut", self.cut_);
        state("changes.lowered", self.lowered_);
        state("changes.lowered_boxes", self.lowered_boxes_);
    }

    std::size_t leaves_ = 0, nodes_ = 0;  // at the last gradation
    std::vector<LeafIndex> cut_leaves_;
    std::vector<Box> cut_boxes_;
    // Of the leaves that were cut: their vertices, or the length at the centre. One that was
    // lowered before is shorter here than what limited its neighbours: more of them may be in doubt
    // than need be, never fewer.
    std::vector<std::conditional_t<at_vertices, Corners, double>> cut_;
    std::vector<NodeIndex> lowered_;
    std::vector<Box> lowered_boxes_;  // of leaves
    std::unordered_set<NodeIndex> is_cut_, is_lowered_;
};

}  // namespace controlspace
