#pragma once

#include <openvdb/tree/NodeManager.h>

#include <optional>

#include "baselines/openvdb/openvdb_value.h"
#include "controlspace/metric/intersection.h"
#include "controlspace/metric/nonconformity.h"

namespace controlspace {

/// Puts tiles in place of leaves whose active voxels are alike: the intersection of their metrics,
/// which requests no larger elements than any of them, where all are within `delta` of it. Inactive
/// voxels do not count. Nodes above the leaves are joined where their tiles are equal, so that
/// tolerances do not add up. openvdb::tools::prune is no way to do it: it compares tensors by their
/// first entry and takes the median.
///
/// Works on all of TBB's threads, with the same result whatever their number.
template <class Tree>
void prune_metrics(Tree& tree, double delta);

namespace detail {

struct Tile {
    VdbMetric value;
    bool active = false;
};

template <class Tree>
class Prune {
public:
    explicit Prune(double delta) : delta_(delta) {}

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
        auto voxel = leaf.cbeginValueOn();
        Metric common = (*voxel).metric;
        while (++voxel) common = intersection(common, (*voxel).metric);
        for (voxel = leaf.cbeginValueOn(); voxel; ++voxel) {
            if (nonconformity(common, (*voxel).metric) > delta_) return std::nullopt;
        }
        return Tile{VdbMetric(common), true};
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
};

}  // namespace detail

template <class Tree>
void prune_metrics(Tree& tree, double delta) {
    tree.clearAllAccessors();
    openvdb::tree::NodeManager<Tree, Tree::DEPTH - 2> nodes(tree);
    nodes.foreachBottomUp(detail::Prune<Tree>(delta));
}

}  // namespace controlspace
