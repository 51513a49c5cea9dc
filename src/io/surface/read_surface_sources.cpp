// SPDX-License-Identifier: Apache-2.0
#include "controlspace/io/read_surface_sources.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <set>
#include <utility>

#include "controlspace/metric/blend.h"
#include "controlspace/metric/intersection.h"
#include "controlspace/metric/order_free_intersection.h"
#include "geometry/random_fractions.h"
#include "io/surface/curvature.h"
#include "io/surface/facing_walls.h"
#include "io/surface/surface_sources.h"
#include "refuse.h"

namespace controlspace {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

struct Bounds {
    double h_min, h_max;
};

void require_valid(const CurvatureSizes& sizes) {
    for (const auto& [name, angle] : {std::pair("an", sizes.angle), {"a crease", sizes.crease}}) {
        if (angle > 0 && angle <= 180) continue;
        refuse("{} angle of {}: give one above 0, up to 180", name, angle);
    }
    if (!is_length(sizes.elements_across)) {
        refuse("{} elements across walls and gaps: give a positive number", sizes.elements_across);
    }
}

Bounds bounds_of(const std::filesystem::path& path, const CurvatureSizes& sizes, double diagonal) {
    const Bounds bounds{sizes.h_min != 0 ? sizes.h_min : 1e-3 * diagonal,
                        sizes.h_max != 0 ? sizes.h_max : 0.1 * diagonal};
    constexpr double most_anisotropic = 1e7;  // of metrics that can be intersected
    if (!is_length(bounds.h_min) || !is_length(bounds.h_max) || bounds.h_min > bounds.h_max ||
        bounds.h_max > most_anisotropic * bounds.h_min) {
        refuse_at(path,
                  "lengths from {} to {}: give other bounds (--surface-h-min, --surface-h-max)",
                  bounds.h_min, bounds.h_max);
    }
    return bounds;
}

double radians(double degrees) { return degrees * std::numbers::pi / 180; }

double shortest(const Metric& m) { return eigen_frame(m).lengths[0]; }

/// `work` for each number below `count`, in parallel.
template <class Work>
void for_each(std::size_t count, const Work& work) {
    tbb::parallel_for(std::uint32_t{0}, static_cast<std::uint32_t>(count), work);
}

/// Part of a triangle. Metrics inside are blended linearly, as lengths on a cone are linear.
struct Piece {
    std::array<Point, 3> at;
    std::array<Metric, 3> metric;
    std::array<bool, 3> is_corner;  ///< of the triangle
    bool raised;                    ///< whether the curvature at a corner asks for less than h_min

    /// Near the centroid, which itself often lies over an edge of the wall behind.
    static constexpr std::array<double, 3> inside{0.35, 0.34, 0.31};

    Point place() const { return inside[0] * at[0] + inside[1] * at[1] + inside[2] * at[2]; }
    Metric metric_there() const {
        return blend_lengths(inside, [&](std::size_t k) { return metric[k]; });
    }
    /// The part that is left where the corner `moved` goes to the middle of the edge to `kept`.
    Piece half(std::size_t kept, std::size_t moved) const {
        Piece half = *this;
        half.at[moved] = 0.5 * (at[kept] + at[moved]);
        half.metric[moved] = blend_lengths(
            2, [](std::size_t) { return 0.5; },
            [&](std::size_t k) { return metric[k == 0 ? kept : moved]; });
        half.is_corner[moved] = false;
        return half;
    }
};

class Sizing {
public:
    Sizing(const SurfaceMesh& mesh, const CurvatureSizes& sizes, const Bounds& bounds)
        : mesh_(mesh),
          patches_(smooth_patches(mesh, radians(sizes.crease))),
          walls_(mesh, patches_),
          bounds_(bounds),
          chord_(2 * std::sin(radians(sizes.angle) / 2)),
          across_(1 / sizes.elements_across),
          isotropic_(sizes.isotropic) {}

    SurfaceSources sources() {
        exact_.resize(mesh_.curvatures.size());
        for_each(exact_.size(),
                 [&](std::uint32_t i) { exact_[i] = metric_of(mesh_.curvatures[i]); });
        metrics_.resize(patches_.fans.size());
        fitted_.resize(patches_.fans.size());
        raised_.resize(patches_.fans.size());
        for_each(metrics_.size(), [&](std::uint32_t i) { metrics_[i] = metric_of_fan(i); });
        std::vector<std::vector<PointSource>> inside(mesh_.triangles.size());
        corner_walls_.resize(mesh_.triangles.size());
        std::vector<std::size_t> raised(mesh_.triangles.size());
        for_each(inside.size(),
                 [&](std::uint32_t t) { divide(t, triangle(t), false, inside[t], raised[t]); });
        SurfaceSources result = at_vertices();
        for (const auto& sources : inside) {
            result.sources.insert(result.sources.end(), sources.begin(), sources.end());
        }
        result.raised += std::reduce(raised.begin(), raised.end());
        result.h_min = bounds_.h_min;
        return result;
    }

private:
    double length(double curvature) const {
        return std::clamp(chord_ / curvature, bounds_.h_min, bounds_.h_max);
    }

    /// Whether a length would be below h_min but for this; not at an apex, which has none.
    bool is_below(double length) const { return length > 0 && length < bounds_.h_min; }

    Metric metric_of(const Curvature& curvature) const {
        const double h1 = length(curvature.along[0]), h2 = length(curvature.along[1]);
        return metric_from_frame({h1, h2, std::min(h1, h2)}, curvature.frame);
    }

    /// Which of the exact metrics a corner of a triangle has.
    std::uint32_t exact_at(std::uint32_t t, std::size_t corner) const {
        return exact_.empty() ? SurfaceMesh::unknown : mesh_.curvature_of[t][corner];
    }

    /// By the curvatures of its faces, of which all count, or by that which is fitted.
    Metric metric_of_fan(std::uint32_t i) {
        std::set<std::uint32_t> faces;
        for (const std::uint32_t t : patches_.fans[i].triangles) {
            for (std::size_t k = 0; k < 3; ++k) {
                if (patches_.fan_of[t][k] == i) faces.insert(exact_at(t, k));
            }
        }
        std::vector<Metric> metrics;
        for (const std::uint32_t face : faces) {
            fitted_[i] = face == SurfaceMesh::unknown;
            const Curvature curvature = fitted_[i] ? curvature_at(mesh_, patches_, patches_.fans[i])
                                                   : mesh_.curvatures[face];
            raised_[i] = raised_[i] || is_below(chord_ / curvature.along[0]);
            metrics.push_back(fitted_[i] ? metric_of(curvature) : exact_[face]);
        }
        return intersection_of(metrics);
    }

    static Metric intersection_of(const std::vector<Metric>& metrics) {
        return metrics.size() == 1 ? metrics.front() : order_free_intersection(metrics).metric();
    }

    /// `m` with the length across a wall or gap.
    Metric with_wall(const Metric& m, const Vector& normal, double thickness) const {
        const double across = std::max(across_ * thickness, bounds_.h_min);
        if (across >= bounds_.h_max) return m;
        return intersection(m, layer_metric(normal, across, bounds_.h_max));
    }

    /// The largest metric within two may be shorter than both, by up to the square root of 2.
    Metric as_wanted(const Metric& m) const {
        EigenFrame frame = eigen_frame(m);
        const double finest = std::max(frame.lengths[0], bounds_.h_min);
        if (isotropic_) return Metric::isotropic(finest);
        if (finest == frame.lengths[0]) return m;
        for (double& length : frame.lengths) length = std::max(length, finest);
        return metric_from_frame(frame.lengths, frame.directions);
    }

    /// A triangle with the exact metrics of its face at its corners, or fitted ones; without these
    /// if it is far flatter itself, as the large triangles of a plate between fillets are.
    Piece triangle(std::uint32_t t) const {
        constexpr double far_flatter = 4;
        const double own = length(patches_.bends[t]);
        Piece piece{.at = {}, .metric = {}, .is_corner = {}, .raised = false};
        for (std::size_t k = 0; k < 3; ++k) {
            const std::uint32_t i = patches_.fan_of[t][k];
            const Fan& fan = patches_.fans[i];
            const std::uint32_t exact = exact_at(t, k);
            const bool flatter = !fan.apex && own > far_flatter * shortest(metrics_[i]);
            piece.at[k] = mesh_.vertices[fan.vertex];
            piece.metric[k] = exact != SurfaceMesh::unknown ? exact_[exact]
                              : flatter                     ? Metric::isotropic(own)
                                                            : metrics_[i];
            piece.is_corner[k] = true;
            piece.raised = piece.raised || raised_[i];
        }
        return piece;
    }

    /// Halves a piece until its edges are short enough, then adds a source there if it `is_part` of
    /// a triangle.
    void divide(std::uint32_t t, const Piece& piece, bool is_part,
                std::vector<PointSource>& sources, std::size_t& raised) {
        constexpr double longest = 2;
        const Point place = piece.place();
        const double wall = walls_.distance(place, t);
        const Metric metric = as_wanted(with_wall(piece.metric_there(), patches_.normals[t], wall));
        std::array<double, 3> edges;
        for (std::size_t k = 0; k < 3; ++k) {
            edges[k] = metric_length(metric, piece.at[(k + 1) % 3] - piece.at[k]);
        }
        const auto widest = std::max_element(edges.begin(), edges.end());
        if (*widest > longest) {
            const auto a = static_cast<std::size_t>(widest - edges.begin()), b = (a + 1) % 3;
            divide(t, piece.half(a, b), true, sources, raised);
            divide(t, piece.half(b, a), true, sources, raised);
            return;
        }
        for (std::size_t k = 0; k < 3; ++k) {
            if (piece.is_corner[k]) corner_walls_[t][k] = wall;
        }
        if (!is_part) return;
        sources.push_back({place, metric});
        raised += piece.raised || is_below(across_ * wall);
    }

    /// The intersection of the metrics of a vertex's fans.
    SurfaceSources at_vertices() const {
        std::vector<std::vector<Metric>> metrics(mesh_.vertices.size());
        std::vector<char> raised(mesh_.vertices.size());
        for (std::uint32_t i = 0; i < patches_.fans.size(); ++i) {
            const Fan& fan = patches_.fans[i];
            double wall = infinity;
            for (const std::uint32_t t : fan.triangles) {
                for (std::size_t k = 0; k < 3; ++k) {
                    if (patches_.fan_of[t][k] == i) wall = std::min(wall, corner_walls_[t][k]);
                }
            }
            raised[fan.vertex] = raised[fan.vertex] || raised_[i] || is_below(across_ * wall);
            metrics[fan.vertex].push_back(with_wall(metrics_[i], fan.normal, wall));
        }
        std::vector<PointSource> sources(mesh_.vertices.size());
        for_each(sources.size(), [&](std::uint32_t v) {
            if (metrics[v].empty()) return;
            sources[v] = {mesh_.vertices[v], as_wanted(intersection_of(metrics[v]))};
        });
        SurfaceSources result;
        for (std::size_t v = 0; v < sources.size(); ++v) {
            if (!metrics[v].empty()) result.sources.push_back(sources[v]);
        }
        result.raised = static_cast<std::size_t>(std::ranges::count(raised, 1));
        result.skipped = sources.size() - result.sources.size();
        std::set<std::uint32_t> fitted;
        for (std::size_t i = 0; i < fitted_.size(); ++i) {
            if (fitted_[i]) fitted.insert(patches_.fans[i].vertex);
        }
        result.fitted = fitted.size();
        return result;
    }

    const SurfaceMesh& mesh_;
    const SmoothPatches patches_;
    const FacingWalls walls_;
    const Bounds bounds_;
    const double chord_, across_;
    const bool isotropic_;
    std::vector<Metric> exact_;                        ///< by the exact curvatures
    std::vector<Metric> metrics_;                      ///< of fans, by curvature
    std::vector<char> fitted_;                         ///< whether a fan's is
    std::vector<char> raised_;                         ///< whether it would be below h_min
    std::vector<std::array<double, 3>> corner_walls_;  ///< distances next to corners of triangles
};

}  // namespace

SurfaceSources surface_sources(const SurfaceMesh& mesh, const CurvatureSizes& sizes,
                               const std::filesystem::path& file) {
    require_valid(sizes);
    return Sizing(mesh, sizes, bounds_of(file, sizes, mesh.diagonal)).sources();
}

std::vector<WallRequest> wall_requests(const SurfaceMesh& mesh, const CurvatureSizes& sizes,
                                       std::size_t rays, std::uint64_t seed,
                                       const std::filesystem::path& file) {
    require_valid(sizes);
    const Bounds bounds = bounds_of(file, sizes, mesh.diagonal);
    SmoothPatches patches = smooth_patches(mesh, radians(sizes.crease));
    patches.normals = triangle_normals(mesh);
    const FacingWalls walls(mesh, patches);
    std::vector<double> area_up_to;
    double area = 0;
    for (const auto& [a, b, c] : mesh.triangles) {
        const Point& p = mesh.vertices[a];
        area_up_to.push_back(area += (mesh.vertices[b] - p).cross(mesh.vertices[c] - p).norm());
    }
    RandomFractions random(seed);
    std::vector<WallRequest> requests;
    for (std::size_t i = 0; i < rays; ++i) {
        const auto found =
            std::upper_bound(area_up_to.begin(), area_up_to.end() - 1, random() * area);
        const auto t = static_cast<std::uint32_t>(found - area_up_to.begin());
        const auto& [a, b, c] = mesh.triangles[t];
        const double u = std::sqrt(random()), v = random();
        const Point place =
            (1 - u) * mesh.vertices[a] + u * (1 - v) * mesh.vertices[b] + u * v * mesh.vertices[c];
        const double thickness = walls.distance(place, t);
        if (thickness == infinity) continue;
        requests.push_back(
            {place, patches.normals[t],
             std::clamp(thickness / sizes.elements_across, bounds.h_min, bounds.h_max)});
    }
    return requests;
}

SurfaceSources read_surface_sources(const std::filesystem::path& path,
                                    const CurvatureSizes& sizes) {
    require_valid(sizes);
    return surface_sources(read_surface_mesh(path), sizes, path);
}

}  // namespace controlspace
