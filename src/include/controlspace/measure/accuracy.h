// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <span>
#include <vector>

#include "controlspace/geometry/box.h"
#include "controlspace/measure/reference.h"
#include "controlspace/sources/point_source.h"
#include "controlspace/space/control_space.h"

namespace controlspace {

/// Cells along x, y and z of a grid with n along each axis, and one across a flat box.
std::array<int, 3> cell_counts(const Box& box, int n);

/// Centres of n x n x n equal cells of `box`, n x n of a flat one, x fastest: coordinate k is
/// low + edge / (2n) + k edge / n, in this order of operations (paper §5.2, n = 30).
/// Throws InputError unless 1 <= n <= 512.
std::vector<Point> cell_centres(const Box& box, int n);

/// Points with the reference metric there; computed once and shared by all structures.
struct Probes {
    std::vector<Point> points;
    std::vector<Metric> reference;
};
Probes make_probes(const ControlSpace& field, std::vector<Point> points);

/// A point counts as coarser if a length of the structure's metric exceeds the reference's by more
/// than this fraction, as finer if the reference's exceeds the structure's. Beyond rounding, and
/// far below the scatter of a mesh's edge lengths.
constexpr double coarser_tolerance = 0.01;

/// Non-conformity δ between a structure and its reference over a set of points; since δ is
/// symmetric, lengths larger and smaller than those of the reference are reported separately. Where
/// the structure's answer is not positive definite, all errors are infinite.
struct Accuracy {
    double max = 0;
    double mean = 0;
    double p95 = 0;               ///< 95th percentile (nearest rank)
    double p99 = 0;               ///< 99th percentile (nearest rank)
    double riemannian_max = 0;    ///< maximum of δ on the Riemannian metrics
    Point worst = Point::Zero();  ///< where max is attained first
    /// Largest ratio, over all points and directions, of the structure's length to the
    /// reference's; at most 1 if it is nowhere longer.
    double coarser_max = 0;
    /// Fraction of the points where that ratio exceeds 1 + coarser_tolerance in some direction.
    double coarser_share = 0;
    /// The same for the reference's lengths to the structure's: a point may be coarser along one
    /// direction and finer along another.
    double finer_max = 0;
    double finer_share = 0;

    /// Largest factor between lengths in any direction, longer or shorter.
    double within() const { return std::max(coarser_max, finer_max); }
};

/// δ_R of the paper (§5.2). Runs on all of TBB's threads, with the same result whatever their
/// number. Throws InputError if there are no probes.
Accuracy accuracy(const ControlSpace& space, const Probes& probes);

/// δ_S of the paper (§5.2): largest δ between a source's metric and the structure's value there;
/// 0 where there are no sources. Runs as `accuracy` does.
double source_accuracy(const ControlSpace& space, std::span<const PointSource> sources);

}  // namespace controlspace
