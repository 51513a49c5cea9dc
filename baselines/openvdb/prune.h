// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tbb/parallel_for.h>

#include <algorithm>
#include <optional>
#include <type_traits>
#include <vector>

#include "baselines/openvdb/openvdb_value.h"
#include "controlspace/metric/intersection.h"
#include "controlspace/metric/nonconformity.h"
#include "controlspace/metric/stored_metric.h"

namespace controlspace {

/// Puts tiles in place of leaves whose active voxels are alike: the intersection of their metrics,
/// which requests no larger elements than any of them, where all are within `delta` of it. Inactive
/// voxels do not count. Nodes above the leaves are joined where their tiles are equal, so that
/// tolerances do not add up. openvdb::tools::prune is no way to do it: it compares tensors by their
/// first entry and takes the median.
///
/// `read(value)` is the metric of a voxel: its tensor, or, of lengths and codes of them, which
/// ascend with the lengths, what stands for its length.
///
/// Works on all of TBB's threads, with the same result whatever their number.
template <class Tree, class Read>
void prune_metrics(Tree& tree, double delta, const Read& read);

namespace detail {

template <class Tree, class Read>
class Prune {
    using Value = typename Tree::ValueType;
    struct Tile {
        Value value;
        bool active;
    };

public:
    Prune(double delta, const Read& read) : delta_(delta), read_(read) {}

    void operator()(typename Tree::RootNodeType& root) const {
        for (auto child = root.beginChildOn(); child; ++child) {
            if (const auto tile = tile_for(*child)) {
                root.addTile(child.getCoord(), tile->value, tile->active);
            }
        }
        root.eraseBackgroundTiles();
    }
    template <class Node>
    void operator()(Node& node) const {
        if constexpr (Node::LEVEL > 0) {
            for (auto child = node.beginChildOn(); child; ++child) {
                if (const auto tile = tile_for(*child)) {
                    node.addTile(child.pos(), tile->value, tile->active);
                }
            }
        }
    }

private:
    std::optional<Tile> tile_for(const typename Tree::LeafNodeType& leaf) const {
        if (leaf.isEmpty()) return std::nullopt;
        const Value common = common_of(leaf);
        const Metric m = read_(common);
        for (auto voxel = leaf.cbeginValueOn(); voxel; ++voxel) {
            if (nonconformity(m, read_(*voxel)) > delta_) return std::nullopt;
        }
        return Tile{common, true};
    }
    Value common_of(const typename Tree::LeafNodeType& leaf) const {
        auto voxel = leaf.cbeginValueOn();
        if constexpr (std::is_arithmetic_v<Value>) {
            Value shortest = *voxel;
            while (++voxel) shortest = std::min(shortest, *voxel);
            return shortest;
        } else {
            Metric common = read_(*voxel);
            while (++voxel) common = intersection(common, read_(*voxel));
            return Value(decltype(Value::metric)(common));
        }
    }

    template <class Node>
    std::optional<Tile> tile_for(const Node& node) const {
        if (!node.isChildMaskOff()) return std::nullopt;
        auto tile = node.cbeginValueAll();
        const Tile first{*tile, tile.isValueOn()};
        while (++tile) {
            if (*tile != first.value || tile.isValueOn() != first.active) return std::nullopt;
        }
        return first;
    }

    double delta_;
    const Read& read_;
};

}  // namespace detail

template <class Tree, class Read>
void prune_metrics(Tree& tree, double delta, const Read& read) {
    tree.clearAllAccessors();
    const detail::Prune<Tree, Read> prune(delta, read);
    using Upper = typename Tree::RootNodeType::ChildNodeType;
    const auto prune_all = [&](auto nodes) {
        tree.getNodes(nodes);
        tbb::parallel_for(std::size_t{0}, nodes.size(), [&](std::size_t i) { prune(*nodes[i]); });
    };
    prune_all(std::vector<typename Upper::ChildNodeType*>());
    prune_all(std::vector<Upper*>());
    prune(tree.root());
}

}  // namespace controlspace
