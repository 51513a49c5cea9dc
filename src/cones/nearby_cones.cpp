#include "cones/nearby_cones.h"

#include <algorithm>
#include <limits>

namespace controlspace {

// Which cones cannot matter in a box
// ----------------------------------
// Let c be the centre of the box and R half its diagonal, f_i(p) = h_i + (g-1) |p - Q_i|, and j the
// cone that is the smallest at c. On the way from c to any p of the box, which is no longer than R,
// f_i - f_j changes at the rate (g-1) |u_i - u_j| at most, with the unit vectors u_i of p - Q_i and
// u_j of p - Q_j. That is never more than 2 (g-1), and never more than
//     2 (g-1) |Q_i - Q_j| / (|p - Q_i| + |p - Q_j|),
// where either distance is the one from c, less R, at least. (For a = |a| u and b = |b| v
//     (|a| + |b|)^2 |u - v|^2 <= 4 |a - b|^2,
// since the right side less the left is 2 (|a| - |b|)^2 (1 + u.v).)
// So i is nowhere smaller than j where f_i(c) - f_j(c) exceeds R times either.

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double rounding = 64 * std::numeric_limits<double>::epsilon();

}  // namespace

void NearbyCones::reset(double slope, double cap) {
    slope_ = slope;
    cap_ = cap;
    cones_.clear();
}

void NearbyCones::narrow(const NearbyCones& others, const Box& box) {
    reset(others.slope_, others.cap_);
    const Point centre = box.centre();
    const double radius = box.half_diagonal() * (1 + rounding);
    const auto& eights = others.cones_.eights();
    distances_.resize(eights.size());
    double smallest = infinity;
    std::size_t smallest_eight = 0;
    for (std::size_t e = 0; e < eights.size(); ++e) {
        const ConeList::Eight& eight = eights[e];
        distances_[e] = eight.distances(centre);
        const double least = (eight.length + slope_ * distances_[e]).minCoeff();
        if (least < smallest) {
            smallest = least;
            smallest_eight = e;
        }
    }
    if (!(smallest < infinity)) return;
    const ConeList::Eight& of_smallest = eights[smallest_eight];
    Eigen::Index lane = 0;
    (of_smallest.length + slope_ * distances_[smallest_eight]).minCoeff(&lane);
    const Point position = of_smallest.position[lane];
    const double distance = std::max(distances_[smallest_eight][lane] - radius, 0.0);

    const double most_change = 2 * slope_ * radius;
    const double room_below_cap = slope_ * radius + cap_;
    for (std::size_t e = 0; e < eights.size(); ++e) {
        const ConeList::Eight& eight = eights[e];
        const Lanes lengths = (eight.length + slope_ * distances_[e]) * (1 - rounding);
        const Lanes gaps = lengths - smallest;
        const Lanes apart = eight.distances(position) * (1 + rounding);
        const Lanes away = (distances_[e] - radius).max(0) + distance;
        for (Eigen::Index i = 0; i < lane_count; ++i) {
            const bool matters = gaps[i] <= most_change && lengths[i] <= room_below_cap &&
                                 gaps[i] * away[i] <= most_change * apart[i];
            if (matters) {
                add(eight.position[i], eight.length[i]);
            }
        }
    }
}

double NearbyCones::smallest_length(const Point& p) const {
    Lanes smallest = Lanes::Constant(cap_);
    for (const ConeList::Eight& eight : cones_.eights()) {
        smallest = smallest.min(eight.length + slope_ * eight.distances(p));
    }
    return smallest.minCoeff();
}

}  // namespace controlspace
