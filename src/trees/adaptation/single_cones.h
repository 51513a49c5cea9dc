// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include "controlspace/geometry/box.h"
#include "controlspace/metric/metric.h"
#include "controlspace/sources/point_source.h"
#include "trees/adaptation/departure.h"

namespace controlspace {

/// Compares metrics in a box with the cones of sources, one cone at a time. A cone is smallest at
/// its source, and in a box at the place that is nearest to the source in the source's metric.
class SingleCones {
public:
    using MetricAt = std::function<Metric(const Point&)>;

    /// The sources must outlive it; those without a gradation ratio have this one.
    SingleCones(std::span<const PointSource> sources, double ratio, double target);

    std::size_t size() const { return sources_.size(); }
    const Point& position(std::size_t source) const { return sources_[source].position; }

    /// How far the metric is beyond the cone where that is smallest in the box: an estimate of
    /// the departure from the field; nothing if it is far below the target.
    Departure at_nearest_place(std::size_t source, const Box& box, const MetricAt& metric_at,
                               std::vector<Point>* contacts = nullptr) const;

    /// False only where that is nothing, by a quicker test, of metrics that are trilinear in the
    /// box between these corners.
    bool may_be_exceeded(std::size_t source, const Box& box,
                         const std::array<Metric, 8>& at_corners) const;

    /// The worst for all cones, of metrics that are trilinear in the box between these corners: at
    /// the nearest places, and elsewhere where a cone is exceeded by more than the target allows.
    /// Appends to `contacts` the nearest places at which the metric is beyond the cone: there
    /// several cones together may make the field shorter than each of them.
    Departure worst_in(const Box& box, const std::array<Metric, 8>& at_corners,
                       const MetricAt& metric_at, std::vector<Point>* contacts = nullptr) const;

    /// Appends places of the box around those that are nearest to sources much nearer than the box
    /// is large, in their metrics: there the field bends within a small part of the box. Each place
    /// once, and none on more faces of the box than `most_faces`: 2 leaves out its corners, 1 also
    /// its edges.
    void append_around_tips(const Box& box, std::ptrdiff_t most_faces,
                            std::vector<Point>& places) const;

private:
    struct Part;
    static Part whole(const Box& box, const std::array<Metric, 8>& at_corners);
    Point nearest_place(std::size_t source, const Box& box) const;
    Departure beyond(std::size_t source, const Metric& own, double most, const Point& x) const;
    unsigned doubtful_corners(std::size_t source, const Part& part, double most) const;
    void find_exceeded(std::size_t source, const Part& leaf, double most,
                       Departure& departure) const;

    std::span<const PointSource> sources_;
    double ratio_, target_;
    // Factors of a cone: in all directions a quarter of the target and the target, and in one.
    double of_interest_, most_, most_along_;
    std::vector<Metric> inverse_squares_;  // of the sources
};

}  // namespace controlspace
