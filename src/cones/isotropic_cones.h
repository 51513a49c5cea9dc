// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "cones/cone_cover.h"
#include "cones/cone_list.h"
#include "cones/cone_tree.h"
#include "cones/trilinear_lengths.h"
#include "controlspace/geometry/box.h"
#include "controlspace/geometry/point.h"
#include "controlspace/sources/point_source.h"
#include "controlspace/sources/source_columns.h"

namespace controlspace {

/// Lower envelope of the cones h_i + (g_i-1) |p - Q_i| of isotropic sources: what the exact field
/// of paper §5.2 is where no source is anisotropic. Branch and bound in a bounding-volume hierarchy
/// with eight children a node.
class IsotropicCones {
public:
    /// All metrics must be isotropic; g >= 1 is the ratio of sources that have none. Lengths of
    /// `cap` or more do not matter.
    ///
    /// Thousands of sources that lie nearly on each other's cones, as the vertices of a graded mesh
    /// do, are searched slowly. Of such, those within 16 epsilon of others' cones are left out, or
    /// those within the factor `longer`, wherever that is half of them at least.
    IsotropicCones(const SourceColumns& sources, double g, double cap, double longer = 1);

    /// Where a search starts from: best at the place where the last one nearby ended.
    using Hint = std::uint32_t;

    /// The smallest length of all cones at `p`, or the cap where none is below it: to the bit the
    /// minimum over all sources, or all that were not left out (`longer`), of `cone_factor` times
    /// the source's length, whatever `hint` is. With a `tolerance`, the same, or up to this
    /// fraction more.
    double smallest_length(const Point& p, Hint& hint, double tolerance = 0) const {
        return search(p, cap_, tolerance, hint);
    }
    /// The same at each of `x`, to the bit, all at once: faster where neighbours in `x` are near to
    /// each other.
    void smallest_lengths(std::span<const Point> x, std::span<double> lengths, Hint& hint) const;

    /// Bounds of the smallest length in a box: `least` is met there, up to rounding, and `most` is
    /// the largest of one source's cone that stays below all others' largest; not above the cap.
    struct Range {
        double least, most;
    };
    Range range_in(const Box& box, Hint& hint) const;

    /// Whether lengths are, everywhere in their box, at most `factor` times longer or shorter than
    /// the smallest length of all cones: then nothing, else a place where not, or where bounds
    /// could not show it. `hint` as in `smallest_length`.
    std::optional<Doubt> doubt_of(const TrilinearLengths& lengths, double factor, Hint& hint) const;

    /// Index of the source that has the `smallest` length at `p`, one of them where several have;
    /// `smallest` and `hint` as `smallest_length` left them, `smallest` below the cap.
    std::uint32_t source_of(const Point& p, double smallest, Hint hint) const {
        return source_in(hint, lane_of(p, smallest, hint));
    }

    /// Makes `nearby` all cones that can be the smallest somewhere in `box`, or returns false where
    /// some hundreds come close to that; `hint` as in `smallest_length`.
    bool gather(const Box& box, ConeList& nearby, Hint& hint) const;

    /// The source that has the smallest length at `p`, if that is less than `length`.
    std::optional<std::uint32_t> source_below(const Point& p, double length, Hint& hint) const;

    /// Chooses sources that cover `box`, by their indices; false where the cover has no room for as
    /// many as it takes.
    bool cover(const Box& box, double tolerance, ConeCover& cover, Hint& hint) const;

    /// Indices of the sources that were not left out, those near to each other together.
    std::span<const std::uint32_t> kept() const { return tree_.indices(); }
    /// Sources that are the smallest nowhere, and were left out.
    std::size_t dropped() const { return dropped_; }
    /// By this factor lengths may be longer than those of all sources: that of the constructor, or
    /// 1, rounding aside.
    double longer() const { return longer_; }
    /// Nodes visited to find what is left out.
    std::size_t visits() const { return visits_; }

    /// Bytes allocated: of the lengths, and of everything else.
    std::size_t bytes_payload() const { return tree_.leaves().size() * sizeof(Leaf::length); }
    std::size_t bytes_topology() const { return tree_.bytes() - bytes_payload(); }

private:
    static constexpr int leaf_size = 16;

    /// Bounds of the sources of each child: a flat cylinder around their positions, their smallest
    /// length and slope. Sources mostly lie on surfaces, whose tangential pieces a cylinder fits
    /// closely where an axis-aligned box does not. Lengths are infinite where there is no child.
    struct Node {
        VectorLanes centre, normal;  ///< of unit length, along the cylinder's axis
        Lanes half_thickness = Lanes::Zero(), radius = Lanes::Zero();
        Lanes length = Lanes::Constant(std::numeric_limits<double>::infinity());
        Lanes slope = Lanes::Zero();

        /// From p to the cylinders, and so to all sources in them: lower bounds.
        Lanes distances(const Point& p) const;
        /// Infinite where a cover around this place covers all sources of a child; else 0.
        Lanes uncovered(const ConeCover& cover, const Point& around) const {
            const Lanes reach = (half_thickness.square() + radius.square()).sqrt();
            const auto covered =
                cover.covered(distances(around), length, slope,
                              [&](const Point& q) -> Lanes { return centre.distances(q) + reach; });
            return covered.select(Lanes::Constant(std::numeric_limits<double>::infinity()),
                                  Lanes::Zero());
        }
    };
    using Leaf = ConeLanes<leaf_size>;
    using Tree = ConeTree<Node, Leaf>;

    struct Visits;
    void build(std::span<ConeTreeItem> items, const SourceColumns& sources, double g);
    bool is_dominated(const IsotropicCone& cone, double below, Visits& visits) const;
    template <class IsFound>
    std::vector<std::uint8_t> found_in(std::span<const ConeTreeItem> items, std::size_t most,
                                       const IsFound& is_found);
    double share_covered(std::span<const ConeTreeItem> items, const SourceColumns& sources,
                         double g, double factor, std::size_t& visits) const;
    bool takes_long(std::span<const ConeTreeItem> items, const SourceColumns& sources,
                    double g) const;
    bool leave_out_covered(std::vector<ConeTreeItem>& items, const SourceColumns& sources, double g,
                           double factor);
    /// Of all cones below, everywhere at most `radius` away from `p`.
    Lanes lower_bounds(const Node& node, const Point& p, double radius = 0) const;
    Eigen::Index lane_of(const Point& p, double smallest, Hint leaf) const;
    std::uint32_t source_in(Hint leaf, Eigen::Index lane) const {
        return tree_.indices()[leaf * std::size_t{leaf_size} + static_cast<std::size_t>(lane)];
    }
    /// Makes the one cone of `cover` that which is the smallest at the centre of `box`, if any is
    /// below the cap, and returns it.
    std::optional<IsotropicCone> cover_by_one(const Box& box, double tolerance, ConeCover& cover,
                                              Hint& hint) const;
    /// Calls add(source, cone) for what the cover leaves of a leaf, until it answers false; then,
    /// returns false.
    template <class Add>
    bool add_uncovered(std::uint32_t number, const ConeCover& cover, const Add& add) const;
    /// Nodes or leaves of one level of the tree, with their bounds: below them are all cones that
    /// are the smallest at one of some places.
    struct Nearby {
        static constexpr std::size_t room = 16;

        std::size_t size = 0;
        std::array<std::uint32_t, room> numbers;
        std::array<Node, room / lane_count> bounds;

        void add(std::uint32_t number, const Node& parent, Eigen::Index child);
    };
    /// Those of the deepest level at which there is room for all; false where the tree is a leaf,
    /// or places are not finite.
    bool find_nearby(std::span<const Point> places, Nearby& nearby, Hint& hint) const;
    double smallest_length(const Point& p, const Nearby& nearby, Hint& hint) const;
    void visit_leaf(Hint leaf, const Point& p, double& smallest, Hint& hint) const;
    std::optional<Doubt> doubt_of_long(const TrilinearLengths& lengths, double factor) const;
    std::optional<Doubt> doubt_of_short(const TrilinearLengths& lengths, double factor,
                                        Hint& hint) const;
    double search(const Point& p, double cap, double tolerance, Hint& hint) const;
    template <class Begin, class LowerBounds, class VisitLeaf>
    double search(double cap, double tolerance, Hint& hint, const Begin& begin,
                  const LowerBounds& lower_bounds, const VisitLeaf& visit_leaf) const;

    double steepest_;  ///< the largest slope
    double cap_;
    double safely_;  ///< just below 1: makes bounds safe against rounding
    double longer_ = 1;
    std::size_t dropped_ = 0;
    std::size_t visits_ = 0;
    Tree tree_;
};

}  // namespace controlspace
