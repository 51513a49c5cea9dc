// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "cones/cone_cover.h"
#include "controlspace/metric/intersection.h"
#include "controlspace/space/control_space.h"
#include "controlspace/space/space_options.h"
#include "metric/interior_point.h"
#include "space/state.h"
#include "trees/adaptation/leaf_places.h"
#include "trees/adaptation/nearby_field.h"
#include "trees/values/anchors.h"
#include "trees/values/growing_cones.h"
#include "trees/values/source_table.h"

namespace controlspace {

/// The sources that govern a leaf in place of a metric (K_LA, K_oLA): a query evaluates their cones
/// at the very place. So the field varies inside a leaf, and distances are straight lines, where
/// values passed from leaf to leaf add up along a path.
///
/// Gradation finds the sources that govern each leaf, at its centre and its corners; the law is
/// always the cone law. A continuous source is kept as it is and evaluated with the cones.
class AnchoredValues {
public:
    explicit AnchoredValues(const SpaceOptions& options);

    /// At the nearest point of the domain.
    Metric value(const Box& domain, LeafIndex leaf, const Point& place) const;
    void prefetch(LeafIndex leaf) const { anchors_.prefetch(leaf); }
    /// The parts of a leaf that is cut have its anchors.
    void split(const Subdivision& subdivision, LeafIndex leaf);
    /// The source becomes an anchor of its leaf.
    SourceIndex add(LeafIndex leaf, const PointSource& source);
    /// What finds the smallest cones of leaves to which many sources are added.
    LongLists long_lists() const { return {anchors_, sources_, ratio_}; }
    /// The value of a leaf, of a list that `is_long`, to the bit.
    Metric value(const Box& domain, LeafIndex leaf, const Point& place, LongLists& lists) const;

    const SourceTable& sources() const { return sources_; }
    double ratio() const { return ratio_; }
    IntersectionRule rule() const { return intersection_; }
    const Metric& largest() const { return largest_; }
    const std::shared_ptr<const ControlSpace>& continuous() const { return continuous_; }
    /// Anchors are from now on taken from the sources of `goal`, with its ratio.
    void take_over(const AdaptationGoal& goal);
    /// Anchors for these leaves, out of the sources of `field`'s goal; if leaves will not be
    /// searched, beside those that may shorten the field somewhere in the leaf: so it never gets
    /// longer.
    void fit(std::span<const CellBox> leaves, const GoalField& field, bool is_searched) {
        // Of tensors hundreds may each cut a little: what governs the centre has to do.
        fits_tensors_loosely_ = !is_searched;
        if (is_searched && are_order_free()) return fit_closely(leaves, field);
        fit(leaves, field, sources_.all_isotropic() || is_searched ? LeafPlaces::all : 1,
            !is_searched);
    }
    /// Anchors for these leaves that keep within the target everywhere in them, of an isotropic
    /// field. Of each: 0 where so many are not enough.
    std::vector<std::uint8_t> cover(std::span<const CellBox> leaves, const GoalField& field);
    bool is_fitted(LeafIndex leaf) const {
        if (fits_tensors_loosely_) return !sources_.all_isotropic();
        return !are_order_free() && anchors_.of(leaf).size() < most_anchors();
    }
    /// The anchors of a leaf and those that it lacks at `x`; empty if it lacks none, or more than
    /// there is room for.
    std::vector<SourceIndex> lacking(LeafIndex leaf, const Point& x, NearbyField& nearby,
                                     const GoalField& field) const;
    void set(LeafIndex leaf, std::span<const SourceIndex> anchors) { anchors_.set(leaf, anchors); }
    /// Forgets sources that are no leaf's anchor.
    void drop_idle_sources();

    /// Throws InputError where a continuous source is kept: it is a program's own.
    void save(StateWriter& state) const;
    /// What was saved of a tree of so many leaves.
    void load(std::size_t leaves, const StateReader& state);

    void describe(Footprint& footprint) const;
    void shrink_to_fit();

private:
    // Anchors of a leaf. Longer lists would make queries slow where one more cut makes them short.
    static constexpr std::size_t most = ConeCover::room;
    // Of tensors without an order, what one solve takes beside the largest metric and a further
    // one.
    static constexpr std::size_t most_order_free = InteriorPoint::room - 2;
    bool are_order_free() const {
        return intersection_ == IntersectionRule::order_free && !sources_.all_isotropic();
    }
    std::size_t most_anchors() const { return are_order_free() ? most_order_free : most; }
    // Of leaves that are not searched, all of few tensors.
    std::size_t most_improved() const { return fits_tensors_loosely_ ? 64 : most_anchors(); }

    // At so many places, the centre first.
    void fit(std::span<const CellBox> leaves, const GoalField& field, std::size_t places,
             bool beside_old);
    // Whether the cone of a source is nowhere in the box shorter than those of the others, or than
    // the largest metric, in any direction; as far as parts of the box show.
    bool is_covered(SourceIndex source, std::span<const SourceIndex> others, const Box& box,
                    int halvings) const;
    // Without an order, at all places of the leaves.
    void fit_closely(std::span<const CellBox> leaves, const GoalField& field);
    struct Known;
    Known known_at(const Point& x, NearbyField& nearby, const GoalField& field) const;
    Metric own_at(const Known& known, std::span<const SourceIndex> anchors) const;
    std::vector<SourceIndex> fitted(std::span<const Known> places, double tolerance) const;
    // The source that `own` exceeds most, of those that govern the place; false if it exceeds none,
    // or there is no room.
    bool add_most_exceeded(const Known& at, const Metric& own,
                           std::vector<SourceIndex>& list) const;
    Metric cones_at(const Point& x, std::span<const SourceIndex> anchors) const;
    Metric largest_within_cones(const Point& x, std::span<const SourceIndex> anchors,
                                const Metric* further) const;
    Metric cones_in_turn(const Point& x, std::span<const SourceIndex> anchors) const;

    AnchorLists anchors_;
    SourceTable sources_;
    std::shared_ptr<const ControlSpace> continuous_;
    Metric largest_;
    double ratio_;
    IntersectionRule intersection_;
    double gap_ = 6e-3;  // of intersections without an order
    bool fits_tensors_loosely_ = false;
};

}  // namespace controlspace
