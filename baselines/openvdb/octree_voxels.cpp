// SPDX-License-Identifier: Apache-2.0
#include "baselines/openvdb/octree_voxels.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace controlspace {

VoxelBoxes::VoxelBoxes(const Octants& tree) {
    leaves.reserve(tree.leaves());
    visit(tree, tree.root(), {0, {0, 0, 0}, {0, 0, 0}});
    std::array<int, 3> most{};
    for (const VoxelBox& leaf : leaves) {
        for (std::size_t a = 0; a < 3; ++a) most[a] = std::max(most[a], leaf.edges[a]);
    }
    for (std::size_t a = 0; a < 3; ++a) voxels[a] = 1 << most[a];
    for (VoxelBox& leaf : leaves) {
        for (std::size_t a = 0; a < 3; ++a) {
            const int halvings = leaf.edges[a];
            leaf.low[a] <<= most[a] - halvings;
            leaf.edges[a] = 1 << (most[a] - halvings);
        }
    }
}

// Here the edges are still numbers of halvings, and low counts boxes of that size.
void VoxelBoxes::visit(const Octants& tree, Ref ref, const VoxelBox& box) {
    if (ref.is_leaf()) {
        leaves.push_back(box);
        leaves.back().leaf = ref.index();
        return;
    }
    const OctreeNode& node = tree.node(ref);
    for (int c = 0; c < node.count(); ++c) {
        const std::size_t slot = node.slot(c);
        VoxelBox child = box;
        for (std::size_t a = 0; a < 3; ++a) {
            if (!node.cuts(a)) continue;
            ++child.edges[a];
            child.low[a] = 2 * child.low[a] + static_cast<std::int32_t>(slot >> a & 1);
        }
        visit(tree, node.children[slot], child);
    }
}

Cuts::Cuts(const Octants& tree, int brick_levels) : brick_levels_(brick_levels) {
    cuts_.reserve(tree.leaves() + tree.inner_nodes());
    note(tree, tree.levels_below(), tree.root(), 0);
    cuts_.shrink_to_fit();
    std::ranges::sort(large_, {}, &Large::begin);
    large_.shrink_to_fit();
}

Octants Cuts::octants(const Box& domain, int brick_levels) const {
    std::vector<OctreeNode> nodes;
    std::size_t next = 0;
    LeafIndex leaves = 0;
    const auto make = [&](const auto& self, const Box& box, int level, int left) -> Ref {
        // Below a brick, as many levels as are left.
        const bool is_above = left == brick_levels && cuts_[next++];
        if (!is_above && left == 0) return Ref::leaf(leaves++);
        const Subdivision parts = OctreeNode::even_subdivision(domain, level, box);
        const std::size_t n = nodes.size();
        nodes.emplace_back(parts);
        for (int c = 0; c < parts.children(); ++c) {
            const Ref child = self(self, parts.child(c), level + 1, is_above ? left : left - 1);
            nodes[n].set_child(nodes[n].slot(c), child);
        }
        return Ref::inner(n);
    };
    make(make, domain, 0, brick_levels);
    return {domain, std::move(nodes)};
}

Box Cuts::leaf_at(const Point& x, const Box& domain) const {
    Box box = domain;
    std::size_t next = 0;
    std::size_t level = 0;
    const auto narrow = [&](bool passes) {
        const Subdivision parts =
            OctreeNode::even_subdivision(domain, static_cast<int>(level), box);
        const OctreeNode node(parts);
        int c = 0;
        for (; node.slot(c) != node.child_with(x); ++c) {
            if (passes) pass(level + 1, next);
        }
        box = parts.child(c);
        ++level;
    };
    while (cuts_[next++]) narrow(true);
    for (int i = 0; i < brick_levels_; ++i) narrow(false);
    return box;
}

void Cuts::note(const Octants& tree, std::span<const std::uint8_t> levels_below, Ref ref,
                std::size_t level) {
    const bool is_cut = !ref.is_leaf() && levels_below[ref.index()] > brick_levels_;
    const std::size_t part = cuts_.size();
    cuts_.push_back(is_cut);
    if (!is_cut) return;
    const OctreeNode& node = tree.node(ref);
    if (level == children_.size()) children_.push_back(node.count());
    for (int c = 0; c < node.count(); ++c) {
        note(tree, levels_below, node.children[node.slot(c)], level + 1);
    }
    constexpr std::size_t many = 256;
    if (cuts_.size() - part >= many) {
        large_.push_back(
            {static_cast<std::uint32_t>(part), static_cast<std::uint32_t>(cuts_.size())});
    }
}

void Cuts::pass(std::size_t level, std::size_t& next) const {
    const auto large = std::ranges::lower_bound(large_, next, {}, &Large::begin);
    if (large != large_.end() && large->begin == next) {
        next = large->end;
    } else if (cuts_[next++]) {
        for (int c = 0; c < children_[level]; ++c) pass(level + 1, next);
    }
}

VoxelOfPlace::VoxelOfPlace(const Box& domain, const Cell& voxels)
    : domain_(domain), voxels_(voxels) {
    constexpr double epsilon = std::numeric_limits<double>::epsilon();
    for (Axis a = 0; a < 3; ++a) {
        const double n = voxels[static_cast<std::size_t>(a)];
        const double edge = domain.edges()[a];
        per_length_[a] = edge > 0 ? n / edge : 0;
        const double reach = std::max(std::abs(domain.low[a]), std::abs(domain.high[a]));
        near_[a] = 8 * epsilon * (n + reach * per_length_[a]);
    }
}

std::int32_t VoxelOfPlace::by_halving(double x, std::size_t axis) const {
    const auto a = static_cast<Axis>(axis);
    double low = domain_.low[a], high = domain_.high[a];
    std::int32_t i = 0;
    for (std::int32_t n = voxels_[axis]; n > 1; n /= 2) {
        const double middle = 0.5 * (low + high);
        const bool is_above = x > middle;
        (is_above ? low : high) = middle;
        i = 2 * i + (is_above ? 1 : 0);
    }
    return i;
}

}  // namespace controlspace
