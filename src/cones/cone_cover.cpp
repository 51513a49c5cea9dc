#include "cones/cone_cover.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace controlspace {

// When one cone covers another in a box
// -------------------------------------
// Let c be the centre of the box, R half its diagonal, and f_i(p) = h_i + (g-1) |p - Q_i|. On the
// way from c to any p of the box f_a - f_i changes at the rate (g-1) |u_a - u_i| at most, with the
// unit vectors of p - Q_a and p - Q_i, and nearby_cones.cpp shows that this is no more than 2 (g-1)
// and no more than 2 (g-1) |Q_a - Q_i| / (|p - Q_a| + |p - Q_i|). So
//     f_a(p) <= f_i(p) + f_a(c) - f_i(c) + R times either,
// which is within the fraction t of f_i(p) where all behind the first f_i is not above
// t (h_i + (g-1) max(|c - Q_i| - R, 0)). Of many sources the same is shown at once by bounds of
// |c - Q_i|, h_i and |Q_a - Q_i|.
//
// In a part of the box R is less, and another source may do: what no source covers in the whole box
// is looked at in its octants, and theirs, before more sources are chosen.

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double rounding = 1e-9;  // and more than that
constexpr std::size_t most_given = 512;

}  // namespace

void ConeCover::List::clear() {
    cones.clear();
    sources.clear();
}

void ConeCover::List::add(std::uint32_t source, const Point& position, double length) {
    cones.add(position, length);
    sources.push_back(source);
}

void ConeCover::reset(const Box& box, double slope, double cap, double tolerance) {
    box_ = box;
    slope_ = slope;
    cap_ = cap;
    tolerance_ = tolerance * (1 - rounding);
    size_ = 0;
    lists_.front().clear();
    enter(box);
}

void ConeCover::enter(const Box& box) {
    centre_ = box.centre();
    radius_ = box.half_diagonal() * (1 + rounding);
    for (std::size_t a = 0; a < size_; ++a) look_at(anchors_[a]);
}

void ConeCover::look_at(Anchor& anchor) const {
    const double distance = (anchor.position - centre_).norm();
    anchor.at_centre = anchor.length + slope_ * distance;
    anchor.away = std::max(distance - radius_, 0.0);
}

bool ConeCover::choose(std::uint32_t source, const Point& position, double length) {
    if (size_ == room) return false;
    sources_[size_] = source;
    anchors_[size_] = {position, length, 0, 0};
    look_at(anchors_[size_++]);
    return true;
}

bool ConeCover::give(std::uint32_t source, const Point& position, double length) {
    if (lists_.front().sources.size() == most_given) return false;
    lists_.front().add(source, position, length);
    return true;
}

void ConeCover::list_uncovered(const List& from, List& to) const {
    to.clear();
    const auto& eights = from.cones.eights();
    for (std::size_t e = 0; e < eights.size(); ++e) {
        const ConeList::Eight& eight = eights[e];
        const auto is_covered = covered(eight.distances(centre_), eight.length,
                                        [&](const Point& q) { return eight.distances(q); });
        if (is_covered.all()) continue;
        for (Eigen::Index i = 0; i < lane_count; ++i) {
            if (is_covered[i]) continue;
            to.add(from.sources[e * lane_count + static_cast<std::size_t>(i)], eight.position[i],
                   eight.length[i]);
        }
    }
}

// Near to the smallest, sources cover the most.
bool ConeCover::choose_smallest(const List& list) {
    double smallest = infinity;
    std::size_t number = 0;
    const auto& eights = list.cones.eights();
    for (std::size_t e = 0; e < eights.size(); ++e) {
        const ConeList::Eight& eight = eights[e];
        Eigen::Index lane = 0;
        const double least = (eight.length + slope_ * eight.distances(centre_)).minCoeff(&lane);
        if (!(least < smallest)) continue;
        smallest = least;
        number = e * lane_count + static_cast<std::size_t>(lane);
    }
    const ConeList::Eight& eight = eights[number / lane_count];
    const auto lane = static_cast<Eigen::Index>(number % lane_count);
    return choose(list.sources[number], eight.position[lane], eight.length[lane]);
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
    const Point centre = box.centre();
    for (int part = 0; part < 8; ++part) {
        Box octant = box;
        for (Axis a = 0; a < 3; ++a) {
            ((part >> a & 1) != 0 ? octant.low : octant.high)[a] = centre[a];
        }
        if (!complete(octant, depth + 1)) return false;
    }
    return true;
}

}  // namespace controlspace
