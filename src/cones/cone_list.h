// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <limits>
#include <vector>

#include "controlspace/geometry/point.h"
#include "controlspace/metric/metric.h"
#include "metric/tensor_lanes.h"

namespace controlspace {

/// The lengths h + s |p - Q|, s = g - 1, that an isotropic source at Q allows.
struct IsotropicCone {
    Point position;
    double length;  ///< h
    double slope;   ///< s

    /// Up to rounding.
    double length_at(const Point& p) const { return length + slope * (p - position).norm(); }
    /// To the bit `cone_factor` times the source's length.
    double exact_length_at(const Point& p) const {
        return (1 + slope * metric_length(Metric::isotropic(length), p - position)) * length;
    }
};

/// Isotropic cones side by side; infinite lengths fill up the last lanes.
template <int n>
struct ConeLanes {
    VectorLanesOf<n> position;
    LanesOf<n> length = LanesOf<n>::Constant(std::numeric_limits<double>::infinity());
    LanesOf<n> slope = LanesOf<n>::Zero();

    LanesOf<n> distances(const Point& p) const { return position.distances(p); }
    /// Up to rounding.
    LanesOf<n> lengths_at(const Point& p) const { return length + slope * distances(p); }
    void set(Eigen::Index lane, const IsotropicCone& cone) {
        position.set(lane, cone.position);
        length[lane] = cone.length;
        slope[lane] = cone.slope;
    }
    IsotropicCone operator[](Eigen::Index lane) const {
        return {position[lane], length[lane], slope[lane]};
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
    void add(const IsotropicCone& cone) {
        const auto lane = static_cast<Eigen::Index>(size_++ % lane_count);
        if (lane == 0) eights_.emplace_back();
        eights_.back().set(lane, cone);
    }

    const std::vector<Eight>& eights() const { return eights_; }
    IsotropicCone operator[](const Place& place) const { return eights_[place.eight][place.lane]; }

    /// The cone that is the smallest at `p`, the first of several; there must be one.
    Place smallest_at(const Point& p) const {
        Place place;
        double smallest = std::numeric_limits<double>::infinity();
        for (std::size_t e = 0; e < eights_.size(); ++e) {
            Eigen::Index lane = 0;
            const double least = eights_[e].lengths_at(p).minCoeff(&lane);
            if (!(least < smallest)) continue;
            smallest = least;
            place = {e, lane};
        }
        return place;
    }

    /// The smallest length at `p`, or `most` where none is below it; up to rounding.
    double smallest_length(const Point& p, double most) const {
        Lanes smallest = Lanes::Constant(most);
        for (const Eight& eight : eights_) smallest = smallest.min(eight.lengths_at(p));
        return smallest.minCoeff();
    }

private:
    std::size_t size_ = 0;
    std::vector<Eight> eights_;
};

}  // namespace controlspace
