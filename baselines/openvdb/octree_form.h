// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <memory>
#include <optional>
#include <type_traits>
#include <utility>

#include "baselines/openvdb/octree_voxels.h"
#include "controlspace/input_errors.h"
#include "controlspace/space/control_nodes.h"
#include "controlspace/space/control_space.h"
#include "space/given_sources.h"
#include "space/saved.h"
#include "trees/growing_tree.h"
#include "trees/topology/topology_state.h"

namespace controlspace {

/// A finished form of an octree whose field a tree of OpenVDB holds: what is that of the octree.
/// One that is only read keeps which parts are cut; one for what comes later the octree itself,
/// `Data`, which its builder shares.
template <class Data>
class OctreeForm : public ControlSpace, public HasControlNodes, public Saved {
public:
    Box domain() const final { return voxel_of_.domain(); }

    /// A leaf of the octree.
    std::optional<Box> cell_at(const Point& x) const final {
        if (octree_) return octree_->cell_at(x);
        return cuts_.leaf_at(nearest_in(domain(), x), domain());
    }
    /// Those of the octree.
    ControlNodes control_nodes(Neighbourhood neighbourhood) const final {
        if (octree_) return octree_->control_nodes(neighbourhood);
        return nodes_of(cuts_.octants(domain()), neighbourhood);
    }
    /// As the octree is saved.
    void save(StateWriter& state) const final {
        if (octree_) return octree_->save(state);
        const Octants octants = cuts_.octants(domain());
        controlspace::save(octants, state);
        save_field(octants, state);
    }

protected:
    OctreeForm(const std::shared_ptr<const Data>& octree, const Cell& voxels, Cuts cuts,
               bool is_only_read)
        : voxel_of_(octree->domain(), voxels), cuts_(std::move(cuts)) {
        if (!is_only_read) octree_ = octree;
    }

    /// Of the octree of a form that is only read, its leaves numbered depth first.
    virtual ControlNodes nodes_of(const Octants& octants, Neighbourhood neighbourhood) const = 0;
    /// Of the same, beside the octree.
    virtual void save_field(const Octants& octants, StateWriter& state) const = 0;

    /// Throws MemoryLimitError.
    static void require_room(double bytes, const Data& octree) {
        const std::size_t most = octree.options().max_bytes;
        if (bytes > static_cast<double>(most)) {
            fail_too_large(static_cast<std::size_t>(bytes), most);
        }
    }
    const VoxelOfPlace& voxel_of() const { return voxel_of_; }
    const Cuts& cuts() const { return cuts_; }
    /// What the tree and the octree take, without what the tree refers to.
    template <class Tree>
    Footprint footprint_of(const Tree& tree) const {
        Footprint footprint;
        footprint.tree_nodes = tree.leafCount() + tree.nonLeafCount();
        footprint.depth = Tree::DEPTH - 1;
        footprint.bytes_auxiliary = cuts_.bytes();
        if (octree_) footprint.bytes_auxiliary += octree_->footprint().bytes_total();
        footprint.bytes_auxiliary += given().bytes();
        if (tree.root().getTableSize() > 1) {
            footprint.remark = fmt::format("{} upper nodes, which a query finds by the root",
                                           tree.root().getTableSize());
        }
        return footprint;
    }

private:
    VoxelOfPlace voxel_of_;
    Cuts cuts_;
    std::shared_ptr<const Data> octree_;
};

}  // namespace controlspace
