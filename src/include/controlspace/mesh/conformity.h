// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "controlspace/mesh/tet_mesh.h"
#include "controlspace/space/control_space.h"

namespace controlspace {

/// Bounds of the classes that the metric lengths of edges are counted in; the first class lies
/// below the first bound, the last one from the last bound on.
inline constexpr std::array<double, 10> length_bounds{0.5, 0.6,  0.7071067811865476, 0.8, 0.9, 1,
                                                      1.1, 1.25, 1.4142135623730951, 2};

/// How well a mesh meets the metric field that it was to be made for: lengths are metric lengths,
/// and 1 is the requested length.
struct Conformity {
    std::size_t nodes = 0;
    std::size_t edges = 0;
    std::size_t tets = 0;
    /// L_R of the paper (§5.3): share of the edges whose length is in [0.8, 1.25). The length of an
    /// edge is the integral of |M^-1 dx| along it by Simpson's rule, from the metrics at its ends
    /// and its middle.
    double l_r = 0;
    /// The same with the metric at the middle alone, as the paper takes it.
    double l_r_middle = 0;
    /// Share of the edges in [1/√2, √2), which the literature of metric-based meshing counts.
    double unit_share = 0;
    double mean_length = 0;
    /// Number of edges in each class of `length_bounds`.
    std::array<std::size_t, length_bounds.size() + 1> histogram{};
    /// Quality of tetrahedra in the metric: 36 / 3^(1/3) V^(2/3) / Σ l², V their volume and l their
    /// edges in the mean of the metrics at their corners. 1 for the regular one, 0 for a flat one.
    double quality_min = 0;
    double quality_mean = 0;
};

/// Measures `mesh` against `field`, the exact one where structures are compared. Samples it at
/// every vertex and the middle of every edge, on all of TBB's threads. Throws InputError for a mesh
/// without tetrahedra.
Conformity conformity(const TetMesh& mesh, const ControlSpace& field);

/// Metric length of the edge from `a` to `b` by Simpson's rule: `at_a`, `at_middle` and `at_b` are
/// the metrics at its ends and its middle.
double edge_length(const Point& a, const Point& b, const Metric& at_a, const Metric& at_middle,
                   const Metric& at_b);

/// Quality of the tetrahedron with these corners in the constant metric `m`, as in Conformity.
double tet_quality(const std::array<Point, 4>& corners, const Metric& m);

/// Each tetrahedron's quality, given the metrics at all vertices.
std::vector<double> tet_qualities(const TetMesh& mesh, std::span<const Metric> at_vertices);

}  // namespace controlspace
