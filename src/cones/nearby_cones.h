#pragma once

#include <cstddef>

#include "cones/cone_list.h"
#include "controlspace/geometry/box.h"
#include "controlspace/geometry/point.h"

namespace controlspace {

/// Those cones of isotropic sources that can be the smallest somewhere in a
/// box: for many queries in it, where they are few.
class NearbyCones {
public:
    /// No cones. Lengths of `cap` or more do not matter.
    void reset(double cap);
    void add(const IsotropicCone& cone) { cones_.add(cone); }
    /// Sets these to those of `others`, which should be all that matter in `box`, that can be the
    /// smallest somewhere in it.
    void narrow(const NearbyCones& others, const Box& box);

    std::size_t size() const { return cones_.size(); }
    /// The smallest length at a place in the box, or the cap where none is below it; to rounding.
    double smallest_length(const Point& p) const;

private:
    double cap_ = 0;
    ConeList cones_;
};

}  // namespace controlspace
