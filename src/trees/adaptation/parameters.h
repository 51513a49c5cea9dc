// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

namespace controlspace {

// Constants of tuning in adaptation. They decide where a search looks and when it ends, and so how
// many cells are made and how sure a sampled target is; none is part of a proof. The history of the
// code states no measurement for them unless one is given here: "chosen" are those that are chosen
// and not measured anew.

/// When a cell is cut.
namespace cutting {
/// Share of the target above which cells are cut where the target is sampled and not proven: a peak
/// is rarely found to its very top. With few sources, whose field is evaluated exactly at every
/// place; otherwise. Chosen.
constexpr double share_of_few = 0.96, share_of_many = 0.99;
/// Share of that above which a cell is improved without a cut, and below which no cell that is
/// searched is: what costs little is done before it is necessary. Chosen.
constexpr double share_to_improve = 0.7;
/// Cells that are too short to be cut and this many times beyond the target (beside a steep cone)
/// are improved in gradation. Chosen.
constexpr double far_off = 10;
/// Rounds over all cells, where a value depends on neighbours that may have been cut since. Chosen.
constexpr int rounds_of_all = 2;
}  // namespace cutting

/// How many places are searched, beside those that cells are fitted to.
namespace sampling {
/// In the domain: the closer the target, the more; not more than the second. At least so many in
/// each cell. Chosen.
constexpr double places_times_target = 5e3, most_places_in_domain = 1e7;
constexpr std::uint64_t least_places_in_cell = 16;
/// Of the sequence beyond these, where the worst place is near to the target. Chosen.
constexpr std::uint64_t more_places = 32;
/// In cells that may not be cut and that bounds do not decide on. Chosen.
constexpr std::uint64_t places_of_unknown = 64;
/// The box in which the sequence lies reaches beyond the cell by this share of its edges: places
/// outside stand for its faces, edges and corners. Chosen.
constexpr double reach_beyond = 0.125;
/// Shares of the target above which cells are searched between their places, and at more of the
/// sequence. Chosen.
constexpr double share_between = 0.5, share_for_more = 0.7;
/// Parts of an edge that is searched. Chosen.
constexpr std::size_t parts_of_edge = 16;
/// An estimate this many times the target need not be confirmed. Chosen.
constexpr double far_above = 1.2;
}  // namespace sampling

/// Comparison with a field that is evaluated roughly at first.
namespace comparing {
/// An estimate of tensors without an order is off by this share of the target at most; what may be
/// above the target, and worse than what is known, but is not beyond the second times it, is
/// evaluated anew. The first is what evaluation promises (GoalField), the second chosen.
constexpr double error_of_estimate = 0.1, surely_above = 1.5;
/// An upper bound below this share of the target needs no exact value. Chosen; callers see it:
/// AdaptationReport::reached is a bound below 3/4 of the target.
constexpr double surely_below = 0.75;
}  // namespace comparing

/// Local maximisation of the error in a cell, from the largest sampled errors. All chosen.
namespace climbing {
constexpr int rounds = 16, fine_rounds = 32;  ///< the latter where the search is thorough
constexpr int tries = 6;                      ///< places of a round
/// Places lie within this share of the cell's edges, at first and in the first fine round; every
/// second one much nearer: peaks at sources are far narrower than their cell.
constexpr double first_reach = 0.25, fine_reach = 0.1, nearer = 0.15;
/// The reach shrinks by this where a round finds nothing higher.
constexpr double shrink = 0.6, fine_shrink = 0.8;
/// A climb goes on as long as it is above a share of the target, which rises from the first by the
/// second a round, up to the third; later on up to the last: most climbs from far below lead
/// nowhere.
constexpr double share_at_first = 0.5, rise = 0.05, share_in_time = 0.65, share_at_last = 0.9;
}  // namespace climbing

/// Comparison with the cones of single sources.
namespace single_cones {
/// Up to so many sources are compared with all cells whatever these hold: in gradation each of few
/// tensors is. Of 512 trilinear cells are (GoalField::few_sources), which takes less time. Chosen.
constexpr std::size_t few = 64;
/// Share of the target below which an exceeded cone is passed over. Chosen.
constexpr double share_of_interest = 0.25;
/// Tips are searched in cells that are nearer than this share of their own length. Chosen.
constexpr double near_tip = 0.25;
/// Parts of a cell in which a cone is searched. Chosen.
constexpr std::size_t parts_of_cell = 256;
}  // namespace single_cones

}  // namespace controlspace
