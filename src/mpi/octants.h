// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "cones/isotropic_cones.h"
#include "mpi/distributed_space.h"
#include "mpi/exchange.h"
#include "mpi/record.h"
#include "mpi/shared_octants.h"
#include "trees/topology/topology.h"

namespace controlspace {

/// 0 where boxes touch or overlap.
inline double distance_between(const Box& a, const Box& b) {
    return (a.low - b.high).cwiseMax(b.low - a.high).cwiseMax(0).norm();
}

/// The parts of the domain that ranks own: leaves of an octree which is the same on all of them.
///
/// Octants are boxes of the serial octree that are cut there for certain, before anything else
/// could have changed them: inserted into, a box that holds M_max is cut by the first source in it
/// that calls for a change, provided that the box is too long for this source, and its parts hold
/// M_max again. (If that source is content with the box, it stays one octant.) Adapted to a field,
/// a box is cut where the bounds of the field in it, or lengths at some places, depart from what it
/// would hold by more than the target, which the ranks find together. (Adapted to tensors, one is
/// cut that is longer than the least length in it.)
class Octants {
public:
    explicit Octants(const Box& domain) : tree_(domain) {}

    /// Collective: cuts octants with many sources, as long as they are cut for certain, and shares
    /// them out. `records` are this rank's sources, `cones` their field if the tree is adapted to
    /// lengths; `steepest` is the largest ratio of all sources.
    Octants(Ranks& ranks, const DistributedOptions& options, std::span<const Record> records,
            const IsotropicCones* cones, double steepest);

    const Topology<OctreeNode>& tree() const { return tree_; }
    std::span<const LeafPlace> places() const { return places_; }
    const Box& box(LeafIndex octant) const { return places_[octant].box; }

    int owner(LeafIndex octant) const { return shared_.owner[octant]; }
    int owner_of(const Point& x) const { return owner(tree_.find(x)); }
    /// All of them, those of each rank together.
    std::span<const LeafIndex> order() const { return shared_.order; }
    std::vector<LeafIndex> of_rank(int rank) const;
    std::vector<Box> boxes_of_rank(int rank) const;
    /// The boxes that two cuts more would make of one, those that the first cut makes together.
    std::vector<Box> parts_of(const LeafPlace& octant) const;
    static constexpr std::size_t most_parts = 64;

    /// Of the sources in an octant, infinite where there are none.
    double least_length(LeafIndex octant) const { return summary_.least_length[octant]; }
    double least_slope(LeafIndex octant) const { return summary_.least_slope[octant]; }

private:
    /// What is known of the sources in each leaf of the octree.
    struct Summary {
        static constexpr double infinity = std::numeric_limits<double>::infinity();
        static constexpr std::uint64_t nothing = ~std::uint64_t{0};

        explicit Summary(std::size_t leaves)
            : count(leaves, 0),
              sum_of_lengths(leaves, 0),
              least_length(leaves, infinity),
              least_slope(leaves, infinity),
              opener(leaves, nothing) {}
        std::vector<std::uint64_t> count;
        std::vector<double> sum_of_lengths, least_length, least_slope;
        /// Of the first source that calls for a change: twice its index, and 1 if the leaf is short
        /// enough for it.
        std::vector<std::uint64_t> opener;
    };

    class Cutting;

    Topology<OctreeNode> tree_;
    std::vector<LeafPlace> places_;
    Summary summary_{0};
    SharedOctants shared_;
};

}  // namespace controlspace
