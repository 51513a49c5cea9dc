// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "controlspace/geometry/box.h"
#include "controlspace/space/control_space.h"
#include "trees/make_room.h"
#include "trees/topology/cut.h"
#include "trees/topology/jump_table.h"

namespace controlspace {

/// A leaf as a descent finds it.
struct LeafPlace {
    LeafIndex leaf = 0;
    std::size_t slot = 0;  ///< where the tree refers to it
    int level = 0;         ///< the root is level 0
    Box box;

    CellBox cell() const { return {leaf, box}; }
};

/// A leaf, or an inner node with all below it, and its box.
struct TreePart {
    Ref ref;
    Box box;
};

/// The leaf that holds `x` below `ref`, which is at `place`.
template <class Node>
LeafPlace descend(std::span<const Node> nodes, Ref ref, LeafPlace place, const Point& x) {
    while (!ref.is_leaf()) {
        const std::size_t inner = ref.index();
        const std::size_t c = nodes[inner].descend(x, place.box);
        place.slot = inner * Node::arity + c;
        ref = nodes[inner].children[c];
        ++place.level;
    }
    place.leaf = ref.index();
    return place;
}

/// Where the leaves of a tree are; what they hold is a LeafModel's affair. Flat: inner nodes in one
/// array, leaves as numbers without gaps.
template <class Node>
class Topology {
public:
    static constexpr int arity = Node::arity;

    explicit Topology(const Box& domain) : domain_(domain), jumps_(domain) {}
    /// Of nodes that make a tree, the root first.
    Topology(const Box& domain, std::vector<Node> nodes)
        : domain_(domain), nodes_(std::move(nodes)), jumps_(domain) {
        if (nodes_.empty()) return;
        root_ = Ref::inner(0);
        std::vector<int> level(nodes_.size(), 0);
        for (std::size_t i = 0; i < nodes_.size(); ++i) {
            const Node& node = nodes_[i];
            deepest_ = std::max(deepest_, level[i] + 1);
            leaves_ += static_cast<LeafIndex>(node.count() - 1);
            for (int c = 0; c < node.count(); ++c) {
                const Ref child = node.children[node.slot(c)];
                if (!child.is_leaf()) level[child.index()] = level[i] + 1;
            }
        }
        fit_jumps();
    }

    const Box& domain() const { return domain_; }
    Ref root() const { return root_; }
    const Node& node(Ref inner) const { return nodes_[inner.index()]; }
    std::span<const Node> nodes() const { return nodes_; }
    std::size_t leaves() const { return leaves_; }
    std::size_t inner_nodes() const { return nodes_.size(); }
    const JumpTable<Ref>& jumps() const { return jumps_; }
    std::size_t bytes_of_jumps() const { return jumps_.bytes(); }
    /// Enters what it consists of, and the bytes that it takes.
    void describe(Footprint& footprint) const {
        footprint.tree_nodes = leaves() + inner_nodes();
        footprint.cells = leaves();
        footprint.depth = deepest_;
        footprint.bytes_topology = nodes_.capacity() * sizeof(Node);
        footprint.bytes_auxiliary = bytes_of_jumps();
    }

    void shrink_to_fit() { controlspace::shrink_to_fit(nodes_); }
    /// Fits the start of descents to the number of leaves: two to four cells for each, in octrees
    /// half to four, which takes 16 bytes a leaf at most. With fewer, queries where leaves are
    /// small take up to twice as long.
    void fit_jumps() {
        const int halvings =
            std::clamp(static_cast<int>(std::bit_width(leaves_)) + 1, 0, largest_jump_table);
        const auto halve = [&](const Box& box, int level) {
            return Node::even_subdivision(domain_, level, box);
        };
        if (jumps_.resize(halvings, halve)) jumps_.enter_all(root_, node_of());
    }
    /// The same while the tree grows, now and then.
    void fit_jumps_roughly() {
        if (leaves_ > 16 * jumps_.cells()) fit_jumps();
    }

    /// The leaf that holds `x`; a place outside the domain is taken for the nearest one inside.
    LeafPlace locate(const Point& x) const {
        return descend(nodes(), root_, {0, root_slot, 0, domain_}, x);
    }

    /// The same, starting at the place of a former leaf that has been split since.
    LeafPlace locate_from(const LeafPlace& parent, const Point& x) const {
        const Ref ref = parent.slot == root_slot
                            ? root_
                            : nodes_[parent.slot / arity].children[parent.slot % arity];
        return descend(nodes(), ref, parent, x);
    }

    /// The number alone of the leaf that holds `x`.
    LeafIndex find(const Point& x) const { return leaf_in(jumps_.at(x), x).index(); }

    /// The leaf of a part of the tree that holds `x`, which must be in that part.
    Ref leaf_in(Ref part, const Point& x) const {
        while (!part.is_leaf()) part = child_with(part, x);
        return part;
    }

    /// As `find`, for at most `most_found` places at a time, whose descents go side by side: while
    /// one waits for memory, others compare.
    static constexpr std::size_t most_found = 128;
    void find(std::span<const Point> x, std::span<LeafIndex> leaves) const {
        std::array<int, most_found> cells;
        std::array<std::uint8_t, most_found> going;
        jumps_.find(x, cells);
        for (std::size_t i = 0; i < x.size(); ++i) leaves[i] = jumps_.at(cells[i], x[i]).bits();
        std::size_t left = 0;
        const auto go_on = [&](std::size_t i) {
            going[left] = static_cast<std::uint8_t>(i);
            left += Ref::from_bits(leaves[i]).is_leaf() ? 0 : 1;
        };
        for (std::size_t i = 0; i < x.size(); ++i) go_on(i);
        while (left > 0) {
            const std::size_t before = std::exchange(left, 0);
            for (std::size_t k = 0; k < before; ++k) {
                const std::size_t i = going[k];
                leaves[i] = child_with(Ref::from_bits(leaves[i]), x[i]).bits();
                go_on(i);
            }
        }
        for (LeafIndex& leaf : leaves.first(x.size())) leaf = Ref::from_bits(leaf).index();
    }

    /// Cuts a leaf. Child 0 keeps the leaf's number, the others get the next ones:
    /// child c > 0 is leaf `leaves() - children + c` afterwards.
    void split(const LeafPlace& place, const Subdivision& subdivision) {
        const Ref inner = Ref::inner(nodes_.size());
        Node node(subdivision);
        node.set_child(0, Ref::leaf(place.leaf));
        for (int c = 1; c < node.count(); ++c) node.set_child(node.slot(c), Ref::leaf(leaves_++));
        make_room(nodes_, 1);
        nodes_.push_back(node);
        deepen_to(place.level + 1);
        graft(place, inner);
    }

    /// The same for many leaves at once: room for so many nodes and more leaves; all are then to
    /// be entered, on any number of threads.
    void grow(std::size_t nodes, std::size_t leaves) {
        make_room(nodes_, nodes);
        nodes_.resize(nodes_.size() + nodes);
        leaves_ += static_cast<LeafIndex>(leaves);
    }
    void enter(std::size_t inner, const Node& node) { nodes_[inner] = node; }
    /// Puts a node, with all below it, in the place of a leaf.
    void graft(const LeafPlace& place, Ref inner) {
        if (place.slot == root_slot) {
            root_ = inner;
        } else {
            nodes_[place.slot / arity].set_child(place.slot % arity, inner);
        }
        jumps_.enter(inner, place.box, node_of());
    }
    /// Some leaf is of that level.
    void deepen_to(int level) { deepest_ = std::max(deepest_, level); }

    /// The same tree with its nodes and leaves in depth-first order; leaf i was `former[i]`.
    Topology depth_first(std::vector<LeafIndex>& former) const {
        Topology ordered(domain_);
        ordered.nodes_.reserve(nodes_.size());
        former.clear();
        former.reserve(leaves_);
        ordered.root_ = ordered.append(*this, root_, former);
        ordered.leaves_ = leaves_;
        ordered.deepest_ = deepest_;
        ordered.fit_jumps();
        return ordered;
    }

    /// Of each inner node, how many levels there are below it.
    std::vector<std::uint8_t> levels_below() const {
        std::vector<std::uint8_t> levels(nodes_.size(), 1);
        // Nodes come after those that they are below.
        for (std::size_t i = nodes_.size(); i-- > 0;) {
            const Node& node = nodes_[i];
            for (int c = 0; c < node.count(); ++c) {
                const Ref child = node.children[node.slot(c)];
                if (child.is_leaf()) continue;
                levels[i] = std::max<std::uint8_t>(levels[i], levels[child.index()] + 1);
            }
        }
        return levels;
    }

    /// Whether so many more leaves would outgrow the references.
    bool is_full(std::size_t leaves) const { return leaves_ + leaves >= Ref::max_index; }

    /// Calls visit(leaf, box) for all leaves, depth first, children in their order.
    template <class Visit>
    void for_each_leaf(Visit&& visit) const {
        for_each_leaf_in({root_, domain_}, visit);
    }
    /// The same in a part of the tree.
    template <class Visit>
    void for_each_leaf_in(const TreePart& part, Visit&& visit) const {
        if (part.ref.is_leaf()) {
            visit(LeafIndex{part.ref.index()}, part.box);
            return;
        }
        for_each_child(part, [&](const TreePart& child) { for_each_leaf_in(child, visit); });
    }
    /// Calls visit(child) for the children of an inner node.
    template <class Visit>
    void for_each_child(const TreePart& inner, Visit&& visit) const {
        for (int c = 0, count = node(inner.ref).count(); c < count; ++c) visit(child(inner, c));
    }
    /// Child `c` of an inner node.
    TreePart child(const TreePart& inner, int c) const {
        const Node& parent = node(inner.ref);
        const std::size_t slot = parent.slot(c);
        TreePart part{parent.children[slot], inner.box};
        parent.narrow(part.box, slot);
        return part;
    }

private:
    static constexpr std::size_t root_slot = ~std::size_t{0};
    static constexpr int largest_jump_table = 24;

    Ref child_with(Ref inner, const Point& x) const {
        const Node& node = nodes_[inner.index()];
        return node.children[node.child_with(x)];
    }

    // Copies a part of another tree; its leaves get the next numbers.
    Ref append(const Topology& other, Ref part, std::vector<LeafIndex>& former) {
        if (part.is_leaf()) {
            former.push_back(part.index());
            return Ref::leaf(static_cast<LeafIndex>(former.size() - 1));
        }
        const std::size_t copy = nodes_.size();
        const Node& node = other.node(part);
        nodes_.push_back(node);
        for (int c = 0; c < node.count(); ++c) {
            const std::size_t slot = node.slot(c);
            const Ref child = append(other, node.children[slot], former);
            nodes_[copy].set_child(slot, child);
        }
        return Ref::inner(copy);
    }

    auto node_of() const {
        return [this](Ref inner) -> const Node& { return node(inner); };
    }

    Box domain_;
    std::vector<Node> nodes_;
    JumpTable<Ref> jumps_;
    Ref root_;
    LeafIndex leaves_ = 1;
    int deepest_ = 0;  // level of any leaf, the root being level 0
};

}  // namespace controlspace
