// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "controlspace/space/control_space.h"

namespace controlspace {

/// A control space as a sizing field of CGAL's Mesh_3 (its concept MeshDomainField_3), for cells,
/// facets and edges:
///
///     Mesh_criteria criteria(CGAL::parameters::facet_size = CgalSizing(field, CgalSizing::facets),
///                            CGAL::parameters::cell_size = CgalSizing(field, CgalSizing::cells));
///
/// Mesh_3 takes upper bounds of radii rather than lengths of edges: `factor` times the
/// smallest length that the metric requests at a point. Keeps a reference to `field`, and is
/// thread-safe as that is: each thread that asks has a cursor. Needs none of CGAL's headers.
class CgalSizing {
public:
    /// Factors with which edges have the lengths that are requested, on average (examples).
    static constexpr double cells = 0.75, facets = 0.7;

    using FT = double;

    explicit CgalSizing(const ControlSpace& field, double factor = 1)
        : field_(field), factor_(factor) {}

    template <class Point3, class Index>
    double operator()(const Point3& p, int /*dimension*/, const Index&) const {
        return factor_ * field_.length_at({p.x(), p.y(), p.z()});
    }

private:
    ThreadCursor field_;
    double factor_;
};

}  // namespace controlspace
