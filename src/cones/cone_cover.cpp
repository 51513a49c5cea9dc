// SPDX-License-Identifier: Apache-2.0
#include "cones/cone_cover.h"

#include <algorithm>
#include <utility>

#include "controlspace/geometry/subdivision.h"

namespace controlspace {

// When one cone covers another in a box
// -------------------------------------
// Let c be the centre of the box, R half its diagonal, and f_i(p) = h_i + s_i |p - Q_i|. On the
// way from c to any p of the box, which is no longer than R, f_a - f_i changes at the rate
// |s_a u_a - s_i u_i| at most, with the unit vectors u_a of p - Q_a and u_i of p - Q_i. That is
// never more than s_a + s_i, and never more than |s_a - s_i| + s_i |u_a - u_i|, or
//     |s_a - s_i| + 2 s_i |Q_a - Q_i| / (|p - Q_a| + |p - Q_i|),
// where either distance is the one from c, less R, at least. (For a = |a| u and b = |b| v
//     (|a| + |b|)^2 |u - v|^2 <= 4 |a - b|^2,
// since the right side less the left is 2 (|a| - |b|)^2 (1 + u.v).) So
//     f_a(p) <= f_i(p) + f_a(c) - f_i(c) + R times either,
// which is within the fraction t of f_i(p) where all behind the first f_i is not above
// t (h_i + s_i max(|c - Q_i| - R, 0)). For many sources the same is shown at once by bounds of
// |c - Q_i|, h_i, s_i and |Q_a - Q_i|.
//
// In a part of the box R is less, and another source may do: what no source covers in the whole box
// is tested in its octants, and theirs, before more sources are chosen.

namespace {

constexpr double rounding = 1e-9;  // and more than that
constexpr std::size_t most_given = 512;

}  // namespace

void ConeCover::reset(const Box& box, double cap, double tolerance) {
    box_ = box;
    cap_ = cap;
    tolerance_ = tolerance * (1 - rounding);
    size_ = 0;
    lists_.front().clear();
    enter(box);
}

void ConeCover::enter(const Box& box) {
    centre_ = box.centre();
    radius_ = box.half_diagonal() * (1 + rounding);
    for (std::size_t a = 0; a < size_; ++a) measure(anchors_[a]);
}

void ConeCover::measure(Anchor& anchor) const {
    const double distance = (anchor.cone.position - centre_).norm();
    anchor.at_centre = anchor.cone.length + anchor.cone.slope * distance;
    anchor.away = std::max(distance - radius_, 0.0);
}

bool ConeCover::choose(std::uint32_t source, const IsotropicCone& cone) {
    if (size_ == room) return false;
    sources_[size_] = source;
    anchors_[size_] = {cone, 0, 0};
    measure(anchors_[size_++]);
    return true;
}

bool ConeCover::give(std::uint32_t source, const IsotropicCone& cone) {
    if (lists_.front().sources.size() == most_given) return false;
    lists_.front().add(source, cone);
    return true;
}

void ConeCover::list_uncovered(const List& from, List& to) const {
    to.clear();
    const auto& eights = from.cones.eights();
    for (std::size_t e = 0; e < eights.size(); ++e) {
        const auto is_covered = covered(eights[e]);
        for (Eigen::Index i = 0; i < lane_count; ++i) {
            if (is_covered[i]) continue;
            to.add(from.sources[ConeList::Place{e, i}.number()], eights[e][i]);
        }
    }
}

// Near to the smallest, sources cover the most.
bool ConeCover::choose_smallest(const List& list) {
    const ConeList::Place place = list.cones.smallest_at(centre_);
    return choose(list.sources[place.number()], list.cones[place]);
}

bool ConeCover::complete() { return complete(box_, 0); }

bool ConeCover::complete(const Box& box, std::size_t depth) {
    enter(box);
    List& left = lists_[depth + 1];
    list_uncovered(lists_[depth], left);
    if (depth == halvings) {
        List& rest = lists_.back();
        while (!left.sources.empty()) {
            if (!choose_smallest(left)) return false;
            list_uncovered(left, rest);
            std::swap(left, rest);
        }
        return true;
    }
    if (left.sources.empty()) return true;
    const Subdivision parts = octants(box);
    for (int c = 0; c < parts.children(); ++c) {
        if (!complete(parts.child(c), depth + 1)) return false;
    }
    return true;
}

}  // namespace controlspace
