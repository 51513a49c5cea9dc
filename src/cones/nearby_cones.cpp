#include "cones/nearby_cones.h"

#include <limits>

#include "cones/cone_cover.h"

namespace controlspace {

void NearbyCones::reset(double cap) {
    cap_ = cap;
    cones_.clear();
}

// A cone matters unless the one that is the smallest at the centre covers it, beyond rounding.
void NearbyCones::narrow(const NearbyCones& others, const Box& box) {
    constexpr double rounding = 64 * std::numeric_limits<double>::epsilon();
    reset(others.cap_);
    if (others.size() == 0) return;
    const Point centre = box.centre();
    const auto& eights = others.cones_.eights();
    const ConeList::Place place = others.cones_.smallest_at(centre);
    const IsotropicCone smallest = others.cones_[place];
    ConeCover cover;
    cover.reset(box, cap_, -rounding);
    cover.choose(0, smallest);
    add(smallest);
    for (const ConeList::Eight& eight : eights) {
        auto covered = cover.covered(eight);
        if (&eight == &eights[place.eight]) covered[place.lane] = true;
        for (Eigen::Index i = 0; i < lane_count; ++i) {
            if (!covered[i]) add(eight[i]);
        }
    }
}

double NearbyCones::smallest_length(const Point& p) const {
    Lanes smallest = Lanes::Constant(cap_);
    for (const ConeList::Eight& eight : cones_.eights()) {
        smallest = smallest.min(eight.lengths_at(p));
    }
    return smallest.minCoeff();
}

}  // namespace controlspace
