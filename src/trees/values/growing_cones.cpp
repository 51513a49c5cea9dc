// SPDX-License-Identifier: Apache-2.0
#include "trees/values/growing_cones.h"

#include <algorithm>

namespace controlspace {

namespace {

// Bounds and lengths of several sources at a time differ from those of one by a few roundings.
constexpr double safely = 1 - 64 * std::numeric_limits<double>::epsilon();

}  // namespace

void GrowingCones::add(SourceIndex source) {
    ++size_;
    recent_.push_back(source);
    if (recent_.size() < most_recent) return;
    std::vector<SourceIndex> members = recent_;
    recent_.clear();
    while (!trees_.empty() && trees_.back().indices().size() <= members.size()) {
        const auto smaller = trees_.back().indices();
        members.insert(members.end(), smaller.begin(), smaller.end());
        trees_.pop_back();
    }
    const double weight = ratio_ > 1 ? 1 / (ratio_ - 1) : 1;
    std::vector<ConeTreeItem> items;
    items.reserve(members.size());
    for (const SourceIndex s : members) {
        const Point& q = sources_.position(s);
        items.push_back({{q.x(), q.y(), q.z(), weight * sources_.metric(s).xx}, s});
    }
    trees_.push_back(made(items));
}

GrowingCones::Tree GrowingCones::made(std::span<ConeTreeItem> items) const {
    Tree tree;
    const auto make_leaf = [&](std::span<const ConeTreeItem> of_leaf, auto& leaf) {
        Eigen::Index lane = 0;
        for (const ConeTreeItem& item : of_leaf) {
            leaf.set(lane++, {item.position(), sources_.metric(item.index).xx, ratio_ - 1});
        }
    };
    const auto make_node = [&](std::span<const Tree::Child> children, Node& node, std::uint32_t) {
        for (std::size_t i = 0; i < children.size(); ++i) {
            const auto of_child = children[i].items;
            if (of_child.empty()) continue;
            const auto lane = static_cast<Eigen::Index>(i);
            Point low = of_child.front().position();
            Point high = low;
            for (const ConeTreeItem& item : of_child) {
                low = low.cwiseMin(item.position());
                high = high.cwiseMax(item.position());
                node.length[lane] = std::min(node.length[lane], sources_.metric(item.index).xx);
            }
            node.low.set(lane, low);
            node.high.set(lane, high);
        }
    };
    tree.build(items, leaf_size, make_leaf, make_node);
    return tree;
}

double GrowingCones::smallest(const Tree& tree, const Point& x, double most) const {
    const auto bounds = [&](const Node& node) -> Lanes {
        const Lanes dx = (node.low.x - x.x()).max(x.x() - node.high.x).max(0);
        const Lanes dy = (node.low.y - x.y()).max(x.y() - node.high.y).max(0);
        const Lanes dz = (node.low.z - x.z()).max(x.z() - node.high.z).max(0);
        const Lanes away = (dx.square() + dy.square() + dz.square()).sqrt();
        return safely * (node.length + (ratio_ - 1) * away);
    };
    tree.search([&] { return most; }, bounds,
                [&](std::uint32_t number) {
                    const auto lengths = tree.leaf(number).lengths_at(x);
                    const std::size_t first = tree.leaf_number(number) * leaf_size;
                    for (std::size_t i = 0; i < leaf_size; ++i) {
                        if (!(safely * lengths[static_cast<Eigen::Index>(i)] < most)) continue;
                        ++evaluated_;
                        most = std::min(most, length_at(tree.indices()[first + i], x));
                    }
                    return true;
                });
    return most;
}

double GrowingCones::smallest(const Point& x, double most) const {
    for (const SourceIndex s : recent_) most = std::min(most, length_at(s, x));
    evaluated_ += recent_.size();
    for (const Tree& tree : trees_) most = smallest(tree, x, most);
    return most;
}

bool LongLists::is_long(LeafIndex leaf) {
    constexpr std::size_t few = 256;
    constexpr int often = 16;
    const auto list = anchors_.of(leaf);
    if (list.size() < few || !are_alike()) return false;
    if (searches_.contains(leaf)) return true;
    if (++evaluations_[leaf] < often) return false;
    GrowingCones& search = searches_.try_emplace(leaf, sources_, ratio_).first->second;
    for (const SourceIndex s : list) search.add(s);
    return true;
}

void LongLists::added(LeafIndex leaf, SourceIndex source) {
    if (!are_alike()) return;
    const auto search = searches_.find(leaf);
    if (search != searches_.end()) search->second.add(source);
}

}  // namespace controlspace
