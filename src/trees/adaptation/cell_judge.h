// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "controlspace/trees/cell_model.h"
#include "trees/adaptation/adapted_cells.h"
#include "trees/adaptation/departure.h"
#include "trees/adaptation/leaf_places.h"
#include "trees/adaptation/nearby_field.h"
#include "trees/adaptation/next_to_sources.h"
#include "trees/adaptation/peaks.h"

namespace controlspace {

/// Compares the cells of a structure with the field of a goal, one after the other: for a thread a
/// copy. A cell is within the target if nothing above it is found, or if bounds prove it.
class CellJudge {
public:
    struct Options {
        double target = 0;         ///< above it cells are cut
        bool is_searched = true;   ///< also at places that cells are not fitted to
        bool is_thorough = false;  ///< at more of them
    };
    /// All but the options must outlive it.
    CellJudge(const AdaptedCells& cells, const GoalField& field, const NextToSources& next_to,
              const Options& options);

    /// What is known of a cell that is judged next.
    struct Known {
        bool is_fresh = false;  ///< it was made, and fitted, since it was judged last
        double at_sources = 0;  ///< the largest δ at sources in it
        Point source = Point::Zero();
        std::uint64_t first_place = 0, end_place = 0;  ///< of the sequence of places
    };
    Judgement judge(const CellBox& cell, const Known& known);
    /// Makes ready for a cell that is not judged.
    void enter(const CellBox& cell) { nearby_.enter(cell.box, true); }

    // For CellModel::judge, of the cell at hand.

    /// By samples.
    Judgement by_samples(const CellBox& cell);
    /// By bounds of an isotropic field (GoalField::has_ranges) that hold everywhere in the cell, of
    /// lengths that are trilinear in it between these corners.
    Judgement by_bounds(const CellBox& cell, const std::array<double, 8>& at_corners);
    /// Whether bounds are wanted: the goal has them, and cells are searched.
    bool may_use_bounds() const { return bounds_; }

    /// What a cell needs to come nearer to the field at the worst place found in it.
    std::vector<std::uint32_t> improvement(const CellBox& cell, const Point& x);
    /// Of a cell that bounds do not decide on: a place above the target, if some samples find one.
    std::optional<Judgement> above_target_at_some_places(const CellBox& cell);

    /// Of LeafPlaces, those at which cells are compared first, since they show how to cut; and how
    /// many of these ranges are of places that cells beside each other, and parts of cells, share.
    struct Range {
        std::size_t from, to;
    };
    static std::span<const Range> ranges(CutBy cut_by);
    static std::size_t shared_ranges(const AdaptedCells& cells);

private:
    // What is found in a cell.
    struct Findings {
        Departure departure;
        Peaks peaks;

        explicit Findings(const CellBox& of) : departure(), peaks(of.box) {}
        void take(double delta, const Point& x) {
            departure.take(delta, x);
            peaks.enter(delta, x);
        }
    };
    // Metrics of the cell and of the field.
    struct Compared {
        std::array<Metric, LeafPlaces::all> held, field;
    };

    Findings begin(const CellBox& cell) const;
    bool is_exceeded(const Findings& found) const {
        return found.departure.worst > options_.target;
    }
    Judgement judgement(const Findings& found) const;

    void at_places_of(const CellBox& of, Findings& found);
    void search(const CellBox& of, Findings& found);
    void at_sequence(const CellBox& of, std::uint64_t first, std::uint64_t end, Findings& found);
    void at_places_between(const CellBox& of, Findings& found);
    void along_edges(const CellBox& of, double slope, Findings& found);
    void examine(const CellBox& of, const Departure& estimate, std::span<const Point> others,
                 Findings& found);
    void climb(const CellBox& of, double slope, Findings& found);

    void compare_at(const CellBox& of, const Range& range, NearbyField::Cones cones,
                    Findings& found, Compared& compared);
    void compare_with(const CellBox& of, std::span<const Point> x, NearbyField::Cones cones,
                      Findings& found);
    void compare_with(const CellBox& of, std::span<const Point> x, NearbyField::Cones cones,
                      Findings& found, std::span<Metric> held, std::span<Metric> field);
    void compare(const Metric& held, const Metric& field, const NearbyField::Accuracy& accuracy,
                 const Point& x, Findings& found);
    std::array<double, 3> sums_along(const Compared& compared) const;

    const AdaptedCells& cells_;
    const GoalField& field_;
    const NextToSources& next_to_sources_;
    Options options_;
    bool bounds_;
    bool is_trilinear_;
    CutBy cut_by_;
    NearbyField nearby_;
    Known known_;
};

/// How much the field changes between the corners of a box, along each axis: cells that are
/// constant are cut by it. `nearby` has entered the box.
std::array<double, 3> change_along(const Box& box, NearbyField& nearby);

}  // namespace controlspace
