// SPDX-License-Identifier: Apache-2.0
#include "controlspace/mesh/conformity.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "controlspace/metric/blend.h"
#include "controlspace/space/sample_parallel.h"
#include "refuse.h"

namespace controlspace {
namespace {

struct Range {
    double from, to;
    bool holds(double x) const { return x >= from && x < to; }
};
constexpr Range conforming{0.8, 1.25};
constexpr Range unit{1 / M_SQRT2, M_SQRT2};

std::vector<Point> middles_of(const TetMesh& mesh, std::span<const Edge> edges) {
    std::vector<Point> middles(edges.size());
    std::transform(edges.begin(), edges.end(), middles.begin(), [&](const Edge& edge) {
        return Point(0.5 * (mesh.vertices[edge[0]] + mesh.vertices[edge[1]]));
    });
    return middles;
}

void count_lengths(const TetMesh& mesh, const ControlSpace& field,
                   std::span<const Metric> at_vertices, Conformity& c) {
    const std::vector<Edge> edges = edges_of(mesh);
    const std::vector<Metric> at_middles = sample_parallel(field, middles_of(mesh, edges));
    std::size_t in_range = 0, in_range_middle = 0, in_unit = 0;
    for (std::size_t i = 0; i < edges.size(); ++i) {
        const auto& [a, b] = edges[i];
        const Point& from = mesh.vertices[a];
        const Point& to = mesh.vertices[b];
        const double length = edge_length(from, to, at_vertices[a], at_middles[i], at_vertices[b]);
        in_range += conforming.holds(length) ? 1 : 0;
        in_range_middle += conforming.holds(metric_length(at_middles[i], to - from)) ? 1 : 0;
        in_unit += unit.holds(length) ? 1 : 0;
        c.mean_length += length;
        const auto bound = std::upper_bound(length_bounds.begin(), length_bounds.end(), length);
        ++c.histogram[static_cast<std::size_t>(bound - length_bounds.begin())];
    }
    const auto n = static_cast<double>(edges.size());
    c.edges = edges.size();
    c.l_r = static_cast<double>(in_range) / n;
    c.l_r_middle = static_cast<double>(in_range_middle) / n;
    c.unit_share = static_cast<double>(in_unit) / n;
    c.mean_length /= n;
}

}  // namespace

double edge_length(const Point& a, const Point& b, const Metric& at_a, const Metric& at_middle,
                   const Metric& at_b) {
    const Vector v = b - a;
    return (metric_length(at_a, v) + 4 * metric_length(at_middle, v) + metric_length(at_b, v)) / 6;
}

double tet_quality(const std::array<Point, 4>& corners, const Metric& m) {
    // M^-1 takes the metric's space to the usual one, where the quality is the usual one too.
    std::array<Vector, 4> x;
    for (std::size_t i = 1; i < 4; ++i) x[i] = to_metric_space(m, corners[i] - corners[0]);
    x[0] = Vector::Zero();
    double squares = 0;
    for (const auto& [a, b] : tet_edges) squares += (x[b] - x[a]).squaredNorm();
    static const double of_regular = 36 / std::cbrt(3.0);
    const double root = std::cbrt(std::max(signed_volume(x[0], x[1], x[2], x[3]), 0.0));
    return of_regular * root * root / squares;
}

std::vector<double> tet_qualities(const TetMesh& mesh, std::span<const Metric> at_vertices) {
    std::vector<double> qualities(mesh.tets.size());
    tbb::parallel_for(std::size_t{0}, qualities.size(), [&](std::size_t i) {
        const Tetrahedron& tet = mesh.tets[i];
        constexpr std::array<double, 4> weights{0.25, 0.25, 0.25, 0.25};
        const Metric mean =
            blend_lengths(weights, [&](std::size_t k) { return at_vertices[tet[k]]; });
        const auto& v = mesh.vertices;
        qualities[i] = tet_quality({v[tet[0]], v[tet[1]], v[tet[2]], v[tet[3]]}, mean);
    });
    return qualities;
}

Conformity conformity(const TetMesh& mesh, const ControlSpace& field) {
    if (mesh.tets.empty()) refuse("a mesh without tetrahedra has nothing to measure");
    Conformity c;
    c.nodes = mesh.vertices.size();
    c.tets = mesh.tets.size();
    const std::vector<Metric> at_vertices = sample_parallel(field, mesh.vertices);
    count_lengths(mesh, field, at_vertices, c);
    const std::vector<double> qualities = tet_qualities(mesh, at_vertices);
    c.quality_min = *std::min_element(qualities.begin(), qualities.end());
    c.quality_mean = std::accumulate(qualities.begin(), qualities.end(), 0.0) /
                     static_cast<double>(qualities.size());
    return c;
}

}  // namespace controlspace
