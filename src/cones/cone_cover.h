// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "cones/cone_list.h"
#include "controlspace/geometry/box.h"
#include "controlspace/geometry/point.h"

namespace controlspace {

/// A choice of isotropic sources whose cones h_i + s_i |p - Q_i| alone make a length that is
/// nowhere in a box longer than the smallest of all sources by more than a fraction, the tolerance.
///
/// Use: `reset`, `choose` a source that is likely to cover many, `give` all sources that `covered`
/// does not show to be covered, then `complete`.
class ConeCover {
public:
    /// Most sources that are chosen.
    static constexpr std::size_t room = 16;

    /// Nothing chosen, nothing given. Lengths of `cap` or more do not matter.
    void reset(const Box& box, double cap, double tolerance);

    /// Which sources at these distances from the centre of the box, with these lengths and slopes
    /// (lower bounds of all three will do), are covered. `apart(q)` is their distance from the
    /// point q, or more.
    template <class Numbers, class Apart>
    auto covered(const Numbers& distances, const Numbers& lengths, const Numbers& slopes,
                 const Apart& apart) const {
        const Numbers away = (distances - radius_).max(0);
        const Numbers least = lengths + slopes * away;
        const Numbers most_at_centre = lengths + slopes * distances + tolerance_ * least;
        auto is_covered = ((1 + tolerance_) * least >= cap_).eval();
        for (std::size_t i = 0; i < size_ && !is_covered.all(); ++i) {
            const Anchor& a = anchors_[i];
            const Numbers gaps = a.at_centre - most_at_centre;
            const double slope = a.cone.slope;
            const Numbers in_parallel = gaps + (slope - slopes).abs() * radius_;
            const Numbers turned = 2 * slopes * radius_ * apart(a.cone.position);
            is_covered = is_covered || gaps + (slope + slopes) * radius_ <= 0 ||
                         (in_parallel <= 0 && in_parallel * (a.away + away) + turned <= 0);
        }
        return is_covered;
    }
    template <int n>
    auto covered(const ConeLanes<n>& cones) const {
        return covered(cones.distances(centre_), cones.length, cones.slope,
                       [&](const Point& q) { return cones.distances(q); });
    }

    /// Chooses this source; false, without effect, if there is no room.
    bool choose(std::uint32_t source, const IsotropicCone& cone);
    /// Records one that is not covered; false if there are too many.
    bool give(std::uint32_t source, const IsotropicCone& cone);
    /// Chooses among the sources given until all of them are covered; false if there is no room.
    bool complete();

    /// The numbers of those chosen.
    std::span<const std::uint32_t> sources() const { return {sources_.data(), size_}; }

private:
    struct Anchor {
        IsotropicCone cone;
        double at_centre;  ///< length of its cone there
        double away;       ///< from all of the box, at least
    };
    struct List {
        ConeList cones;
        std::vector<std::uint32_t> sources;

        void clear() {
            cones.clear();
            sources.clear();
        }
        void add(std::uint32_t source, const IsotropicCone& cone) {
            cones.add(cone);
            sources.push_back(source);
        }
    };
    static constexpr std::size_t halvings = 2;

    void enter(const Box& box);
    void measure(Anchor& anchor) const;
    void list_uncovered(const List& from, List& to) const;
    bool choose_smallest(const List& list);
    bool complete(const Box& box, std::size_t depth);

    Box box_;
    double cap_ = 0, tolerance_ = 0;
    Point centre_ = Point::Zero();
    double radius_ = 0;
    std::size_t size_ = 0;
    std::array<Anchor, room> anchors_;
    std::array<std::uint32_t, room> sources_{};
    // What was given, what of it is not covered in the box, in a part of it, in a part of that, and
    // room for one more.
    std::array<List, halvings + 3> lists_;
};

}  // namespace controlspace
