#pragma once

#include <cstddef>
#include <limits>
#include <vector>

#include "controlspace/geometry/point.h"
#include "metric/tensor_lanes.h"

namespace controlspace {

/// Isotropic cones h_i + (g-1) |p - Q_i| side by side; infinite lengths fill up the last lanes.
template <int n>
struct ConeLanes {
    VectorLanesOf<n> position;
    LanesOf<n> length = LanesOf<n>::Constant(std::numeric_limits<double>::infinity());

    LanesOf<n> distances(const Point& p) const { return position.distances(p); }
    /// Up to rounding. `slope` is g - 1.
    LanesOf<n> lengths_at(const Point& p, double slope) const {
        return length + slope * distances(p);
    }
};

/// Isotropic cones in groups of eight.
class ConeList {
public:
    using Eight = ConeLanes<lane_count>;

    /// Where a cone is in the list.
    struct Place {
        std::size_t eight = 0;
        Eigen::Index lane = 0;

        std::size_t number() const { return eight * lane_count + static_cast<std::size_t>(lane); }
    };

    void clear() {
        size_ = 0;
        eights_.clear();
    }
    void add(const Point& position, double length) {
        const auto lane = static_cast<Eigen::Index>(size_++ % lane_count);
        if (lane == 0) eights_.emplace_back();
        eights_.back().position.set(lane, position);
        eights_.back().length[lane] = length;
    }

    std::size_t size() const { return size_; }
    const std::vector<Eight>& eights() const { return eights_; }

    /// The cone that is the smallest at `p`, the first of several; there must be one.
    Place smallest_at(const Point& p, double slope) const {
        Place place;
        double smallest = std::numeric_limits<double>::infinity();
        for (std::size_t e = 0; e < eights_.size(); ++e) {
            Eigen::Index lane = 0;
            const double least = eights_[e].lengths_at(p, slope).minCoeff(&lane);
            if (!(least < smallest)) continue;
            smallest = least;
            place = {e, lane};
        }
        return place;
    }

private:
    std::size_t size_ = 0;
    std::vector<Eight> eights_;
};

}  // namespace controlspace
