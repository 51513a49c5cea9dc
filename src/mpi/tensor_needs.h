// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "cones/order_free_cones.h"
#include "mpi/exchange.h"
#include "mpi/octants.h"
#include "mpi/record.h"

namespace controlspace {

/// Which tensors of this rank matter in which octants.
///
/// The field is the largest metric within all cones. With the multipliers L_k of those which
/// determine it at the centre c of a box, from any of the sources, no metric Y within all cones has
/// sum tr(L_k Y) > sum tr(L_k B_k(c)), B_k the squared cones: that bounds Y, as each B_k does. By
/// the law of gradation the bounds, a little longer, hold in the whole box. A cone that some bound
/// is within touches the field nowhere in the box, and is not needed there.
class TensorNeeds {
public:
    /// Collective. `own` are the sources of this rank, in its octants; `parts` are the boxes of
    /// each of these. `octants` must outlive it.
    TensorNeeds(Ranks& ranks, const Octants& octants, const SpaceOptions& space, double steepest,
                std::span<const Record> own, const std::vector<std::vector<Box>>& parts);

    /// Own sources but for those that others dominate.
    std::size_t kept() const;
    /// By source: whether it matters in any of some octants.
    std::vector<std::uint8_t> matter_in(std::span<const LeafIndex> octants) const;

private:
    /// The field in a box is shorter than the cones which `factor` does not exceed at `place`.
    struct Test {
        Point place;
        Eigen::Matrix3d factor;
    };
    std::vector<PointSource> own_and_some(Ranks& ranks, std::span<const Record> own) const;
    Test test_in(const Box& box, std::span<const PointSource> sources,
                 OrderFreeCones::Search& search) const;

    const Octants& octants_;
    double ratio_, slope_;  // of cones; that of the steepest
    Metric largest_;
    std::size_t own_;
    std::unique_ptr<OrderFreeCones> cones_;
    std::vector<Test> tests_;              // of octants, one after the other
    std::vector<std::size_t> first_test_;  // of each octant
    std::vector<int> count_;               // likewise
};

}  // namespace controlspace
