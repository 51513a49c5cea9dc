#include "cones/nearby_cones.h"

#include <limits>

#include "cones/cone_cover.h"

namespace controlspace {

void NearbyCones::reset(double slope, double cap) {
    slope_ = slope;
    cap_ = cap;
    cones_.clear();
}

// A cone matters unless the one that is the smallest at the centre covers it, beyond rounding.
void NearbyCones::narrow(const NearbyCones& others, const Box& box) {
    constexpr double rounding = 64 * std::numeric_limits<double>::epsilon();
    reset(others.slope_, others.cap_);
    if (others.size() == 0) return;
    const Point centre = box.centre();
    const auto& eights = others.cones_.eights();
    const auto [e, lane] = others.cones_.smallest_at(centre, slope_);
    const Point position = eights[e].position[lane];
    const double length = eights[e].length[lane];
    ConeCover cover;
    cover.reset(box, slope_, cap_, -rounding);
    cover.choose(0, position, length);
    add(position, length);
    for (const ConeList::Eight& eight : eights) {
        auto covered = cover.covered(eight);
        if (&eight == &eights[e]) covered[lane] = true;
        for (Eigen::Index i = 0; i < lane_count; ++i) {
            if (!covered[i]) add(eight.position[i], eight.length[i]);
        }
    }
}

double NearbyCones::smallest_length(const Point& p) const {
    Lanes smallest = Lanes::Constant(cap_);
    for (const ConeList::Eight& eight : cones_.eights()) {
        smallest = smallest.min(eight.lengths_at(p, slope_));
    }
    return smallest.minCoeff();
}

}  // namespace controlspace
