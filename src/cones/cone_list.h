#pragma once

#include <cstddef>
#include <limits>
#include <vector>

#include "cones/tensor_lanes.h"
#include "controlspace/geometry/point.h"

namespace controlspace {

/// Isotropic cones, eight by eight.
class ConeList {
public:
    struct Eight {
        VectorLanes position;
        Lanes length;  ///< infinite lengths fill up the last lanes

        Lanes distances(const Point& p) const { return norms(displacements(position, p)); }
    };

    void clear() {
        size_ = 0;
        eights_.clear();
    }
    void add(const Point& position, double length) {
        const auto lane = static_cast<Eigen::Index>(size_++ % lane_count);
        if (lane == 0) {
            eights_.emplace_back();
            eights_.back().position = VectorLanes::zero();
            eights_.back().length.setConstant(std::numeric_limits<double>::infinity());
        }
        eights_.back().position.set(lane, position);
        eights_.back().length[lane] = length;
    }

    std::size_t size() const { return size_; }
    const std::vector<Eight>& eights() const { return eights_; }

private:
    std::size_t size_ = 0;
    std::vector<Eight> eights_;
};

}  // namespace controlspace
