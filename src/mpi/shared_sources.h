// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bitset>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "mpi/distributed_space.h"
#include "mpi/exchange.h"
#include "mpi/octants.h"
#include "mpi/record.h"
#include "mpi/tensor_needs.h"

namespace controlspace {

/// The sources of all ranks, each with the owner of its octant, and which of them matter elsewhere.
///
/// Of lengths, the field is the minimum of cones, to the bit, whatever other cones are searched.
/// Some cone stays below U everywhere in an octant B: what is above U everywhere in B is nowhere
/// the smallest in it, nor is it in bounds of any box inside of B. All others matter in B, up to
/// rounding. Of tensors: TensorNeeds.
class SharedSources {
public:
    /// Collective: sends this rank's sources to the owners of their octants, and finds bounds of
    /// the field in each octant. `ranks` and `octants` must outlive it. `has_tensors`: whether any
    /// rank has; `steepest` is the largest ratio of all sources.
    SharedSources(Ranks& ranks, const Octants& octants, const DistributedOptions& options,
                  bool has_tensors, double steepest, std::vector<Record>&& records);

    std::size_t owned() const { return records_.size(); }
    /// Of them, those that none of the others there dominates.
    std::size_t kept() const { return kept_; }

    /// Collective, the one exchange: the sources that matter in the octants that each rank wants,
    /// or lie in those that it has `whole`, in the order that they have in all; `received` are
    /// those of other ranks.
    std::vector<PointSource> near(const std::vector<std::vector<LeafIndex>>& wanted,
                                  const std::vector<std::vector<LeafIndex>>& whole,
                                  std::uint64_t& received);

private:
    struct Bound;
    /// A box in which the field is nowhere longer than `most`.
    struct Test {
        Box box;
        double most;
    };
    struct OwnSources {
        std::vector<std::uint32_t> all, kept;
    };

    std::vector<Record> exchange(const std::vector<std::vector<Record>>& to) const;
    void find_filled_parts();
    std::vector<Box> test_boxes(const LeafPlace& octant) const;
    void find_bounds();
    void find_needs();  // collective
    Bound bound_of(const Record& r) const;
    std::vector<double> bounds_of_octants();
    std::vector<std::uint8_t> matter_in(std::span<const LeafIndex> octants) const;
    std::span<const Test> tests_of(LeafIndex octant) const;

    Ranks& ranks_;
    const Octants& octants_;
    SpaceOptions space_;
    double steepest_, ratio_, cap_;
    /// Where the field counts: everywhere, or in leaves cut for sources, at centres or corners.
    enum class Counts : std::uint8_t { everywhere, at_centres, at_corners };
    Counts counts_;
    bool has_tensors_;
    std::vector<Record> records_;  // owned
    std::size_t kept_ = 0;
    std::vector<LeafIndex> own_octants_;
    std::vector<OwnSources> sources_in_;                    // of octants
    std::vector<std::bitset<Octants::most_parts>> filled_;  // of octants: parts with sources
    std::vector<Test> tests_;                               // of octants, one after the other
    std::vector<std::size_t> first_test_;                   // of each octant, and the end
    std::unique_ptr<TensorNeeds> tensors_;
};

}  // namespace controlspace
