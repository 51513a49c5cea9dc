// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <unordered_map>
#include <vector>

#include "cones/cone_list.h"
#include "cones/cone_tree.h"
#include "controlspace/geometry/point.h"
#include "trees/values/anchors.h"
#include "trees/values/source_table.h"

namespace controlspace {

/// The smallest of the cones of isotropic sources that grow alike, searched while more sources
/// come: in trees that are built once, each of a size of its own, of which those that a new one
/// reaches in size become part of it. n sources take a time of n log^2 n to enter; a search visits
/// log n trees.
class GrowingCones {
public:
    /// Of sources of this table, which must outlive it, all with this ratio.
    GrowingCones(const SourceTable& sources, double ratio) : sources_(sources), ratio_(ratio) {}

    void add(SourceIndex source);
    std::size_t size() const { return size_; }

    /// The least h + (g-1) |x - Q| that is below `most`, or that: to the bit, as `length_at` has
    /// it.
    double smallest(const Point& x, double most) const;
    double length_at(SourceIndex source, const Point& x) const {
        return sources_.metric(source).xx + (ratio_ - 1) * (x - sources_.position(source)).norm();
    }
    /// Cones evaluated so far, one by one.
    std::size_t evaluated() const { return evaluated_; }

private:
    static constexpr std::size_t leaf_size = 16;
    static constexpr std::size_t most_recent = 64;

    /// Of each child a box around its sources, and their smallest length.
    struct Node {
        VectorLanes low, high;
        Lanes length = Lanes::Constant(std::numeric_limits<double>::infinity());
    };
    using Tree = ConeTree<Node, ConeLanes<leaf_size>>;

    Tree made(std::span<ConeTreeItem> items) const;
    double smallest(const Tree& tree, const Point& x, double most) const;

    const SourceTable& sources_;
    double ratio_;
    std::size_t size_ = 0;
    std::vector<SourceIndex> recent_;  // not yet in a tree
    std::vector<Tree> trees_;          // the largest first
    mutable std::size_t evaluated_ = 0;
};

/// The smallest cones of leaves with long lists of anchors, isotropic and of one ratio, while
/// sources are inserted. A list that is evaluated often gets a search.
class LongLists {
public:
    LongLists(const AnchorLists& anchors, const SourceTable& sources, double ratio)
        : anchors_(anchors), sources_(sources), ratio_(ratio) {}

    /// Whether the list of the leaf is evaluated here.
    bool is_long(LeafIndex leaf);
    /// The smallest cone of the leaf's anchors at `x` that is below `most`, or that. Only where it
    /// `is_long`.
    double smallest(LeafIndex leaf, const Point& x, double most) {
        return searches_.at(leaf).smallest(x, most);
    }
    /// After an anchor was added to the leaf.
    void added(LeafIndex leaf, SourceIndex source);

private:
    bool are_alike() const { return sources_.all_isotropic() && sources_.all_grow_alike(); }

    const AnchorLists& anchors_;
    const SourceTable& sources_;
    double ratio_;
    std::unordered_map<LeafIndex, GrowingCones> searches_;
    std::unordered_map<LeafIndex, int> evaluations_;  // of long lists that have no search
};

}  // namespace controlspace
