#pragma once

#include <memory>
#include <span>
#include <vector>

#include "geometry/point.h"
#include "metric/metric.h"
#include "sources/point_source.h"

namespace controlspace {

/// The field that structures are measured against. Reading is thread-safe.
class ReferenceField {
public:
    virtual ~ReferenceField() = default;

    /// Metrics at `x`; out.size() == x.size(). Large batches run on all of TBB's threads.
    virtual void evaluate(std::span<const Point> x, std::span<Metric> out) const = 0;
};

/// The exact field of paper §5.2: at p, the intersection of the cones
/// M_i (1 + (g-1) |M_i^-1 (p - Q_i)|) of all sources i, and of `largest`.
///
/// Intersecting three or more tensors depends on their order, so the order is part of the
/// definition: cones are taken by their smallest length at p, ascending, and by index where equal.
std::unique_ptr<ReferenceField> exact_reference(std::vector<PointSource> sources, double g,
                                                const Metric& largest);

/// The same by intersecting with every source: the oracle of the tests.
std::unique_ptr<ReferenceField> brute_force_reference(std::vector<PointSource> sources, double g,
                                                      const Metric& largest);

/// What the paper's Table 4 was measured against, for spheres around the origin: the isotropic
/// field h(p) = min(largest, h + s ||p| - radius|), s = 2 (g-1) / (g+1).
std::unique_ptr<ReferenceField> published_sphere_reference(double radius, double h, double g,
                                                           double largest);

}  // namespace controlspace
