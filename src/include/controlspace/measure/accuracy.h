#pragma once

#include <span>
#include <vector>

#include "controlspace/geometry/box.h"
#include "controlspace/measure/reference.h"
#include "controlspace/sources/point_source.h"
#include "controlspace/space/control_space.h"

namespace controlspace {

/// Centres of n x n x n equal cells of `box`, x fastest: coordinate k is
/// low + edge / (2n) + k edge / n, in this order of operations (paper §5.2, n = 30).
/// Throws InputError unless 1 <= n <= 512.
std::vector<Point> cell_centres(const Box& box, int n);

/// Places where the reference is known; computed once and shared by all structures.
struct Probes {
    std::vector<Point> points;
    std::vector<Metric> reference;
};
Probes make_probes(const MetricField& field, std::vector<Point> points);

/// A place counts as coarser where some length that the structure asks for is longer than the
/// reference's by more than this part of it. Beyond rounding, and far below what the lengths of a
/// mesh's edges scatter by.
constexpr double coarser_tolerance = 0.01;

/// Non-conformity δ between a structure and its reference over a set of places; and apart from it,
/// since δ is symmetric, the errors of the dangerous kind, larger elements than the reference asks
/// for. Where the structure answers something that is no metric, all errors are infinite.
struct Accuracy {
    double max = 0;
    double mean = 0;
    double p95 = 0;               ///< 95th percentile (nearest rank)
    double p99 = 0;               ///< 99th percentile (nearest rank)
    double riemannian_max = 0;    ///< maximum of δ on the Riemannian metrics
    Point worst = Point::Zero();  ///< where max is; the first such place
    /// Largest ratio, over all places and directions, of the length that the structure asks for to
    /// the reference's; 1 or less where it is nowhere longer.
    double coarser_max = 0;
    /// Share of the places where that ratio is above 1 + coarser_tolerance in some direction.
    double coarser_share = 0;
};

/// δ_R of the paper (§5.2). Runs on all of TBB's threads, with the same result whatever their
/// number. Throws InputError if there are no probes.
Accuracy accuracy(const ControlSpace& space, const Probes& probes);

/// δ_S of the paper (§5.2): largest δ between a source's metric and the structure's value there;
/// 0 where there are no sources. Runs as `accuracy` does.
double source_accuracy(const ControlSpace& space, std::span<const PointSource> sources);

}  // namespace controlspace
