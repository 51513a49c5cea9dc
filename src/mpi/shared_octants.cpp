// SPDX-License-Identifier: Apache-2.0
// The octree as a forest of p4est, which orders and shares out its leaves.
#define OMPI_SKIP_MPICXX 1
#define MPICH_SKIP_MPICXX 1
#include "mpi/shared_octants.h"

#include <p8est.h>
#include <p8est_bits.h>
#include <p8est_extended.h>

#include <algorithm>
#include <memory>
#include <optional>

#include "mpi/exchange.h"

namespace controlspace {
namespace {

/// A box of level L of the tree is the quadrant of level L whose coordinates, bit by bit from the
/// top, are the sides that the box lies on, 0 where an axis is not cut. So the domain is a corner
/// of p4est's cube where it is longer along some axes; quadrants beyond have no leaf.
class Forest {
public:
    Forest(MPI_Comm comm, const Topology<OctreeNode>& tree, std::span<const std::uint64_t> weights)
        : tree_(tree), weights_(weights) {
        [[maybe_unused]] static const bool once = [] {
            sc_init(MPI_COMM_WORLD, 0, 0, nullptr, SC_LP_SILENT);
            p4est_init(nullptr, SC_LP_SILENT);
            return true;
        }();
        forest_ = {p8est_new_ext(comm, connectivity_.get(), 0, 0, 1, 0, nullptr, this),
                   p8est_destroy};
        p8est_refine(forest_.get(), 1, is_cut, nullptr);
        p8est_partition(forest_.get(), 0, weight);
    }

    /// Those of this rank, in p4est's order.
    std::vector<LeafIndex> own() const {
        std::vector<LeafIndex> leaves;
        if (forest_->local_num_quadrants == 0) return leaves;
        sc_array_t* quadrants = &p8est_tree_array_index(forest_->trees, 0)->quadrants;
        for (std::size_t i = 0; i < quadrants->elem_count; ++i) {
            const auto part = part_of(*p8est_quadrant_array_index(quadrants, i));
            if (part) leaves.push_back(part->index());
        }
        return leaves;
    }

private:
    // The part of the tree that a quadrant is; none beyond the domain.
    std::optional<Ref> part_of(const p8est_quadrant_t& q) const {
        Ref part = tree_.root();
        for (int level = 1; level <= q.level; ++level) {
            if (part.is_leaf()) return std::nullopt;  // only where an axis is not cut
            const OctreeNode& node = tree_.node(part);
            const int bit = P8EST_MAXLEVEL - level;
            std::size_t slot = 0;
            for (std::size_t a = 0; a < 3; ++a) {
                const p4est_qcoord_t at = a == 0 ? q.x : a == 1 ? q.y : q.z;
                if ((at >> bit & 1) == 0) continue;
                if (!node.cuts(a)) return std::nullopt;
                slot |= std::size_t{1} << a;
            }
            part = node.children[slot];
        }
        return part;
    }
    static const Forest& of(const p8est_t* forest) {
        return *static_cast<const Forest*>(forest->user_pointer);
    }
    static int is_cut(p8est_t* forest, p4est_topidx_t, p8est_quadrant_t* q) {
        const auto part = of(forest).part_of(*q);
        return part && !part->is_leaf() ? 1 : 0;
    }
    static int weight(p8est_t* forest, p4est_topidx_t, p8est_quadrant_t* q) {
        const Forest& self = of(forest);
        const auto part = self.part_of(*q);
        if (!part) return 0;
        // p4est adds them up in 64 bits, but each has 31.
        constexpr std::uint64_t most = 1u << 30;
        return static_cast<int>(std::min(self.weights_[part->index()], most));
    }

    const Topology<OctreeNode>& tree_;
    std::span<const std::uint64_t> weights_;
    std::shared_ptr<p8est_connectivity_t> connectivity_{p8est_connectivity_new_unitcube(),
                                                        p8est_connectivity_destroy};
    std::shared_ptr<p8est_t> forest_;
};

}  // namespace

SharedOctants share_out(MPI_Comm comm, const Topology<OctreeNode>& tree,
                        std::span<const std::uint64_t> weights) {
    Ranks ranks(comm);
    const auto all = ranks.gather(Forest(comm, tree, weights).own());
    SharedOctants shared{std::vector<int>(tree.leaves()), all.values};
    std::size_t next = 0;
    for (std::size_t r = 0; r < all.counts.size(); ++r) {
        for (int i = 0; i < all.counts[r]; ++i) {
            shared.owner[all.values[next++]] = static_cast<int>(r);
        }
    }
    return shared;
}

}  // namespace controlspace
