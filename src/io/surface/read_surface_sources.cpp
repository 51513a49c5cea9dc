#include "controlspace/io/read_surface_sources.h"

#include <CGAL/Eigen_svd.h>
#include <CGAL/Monge_via_jet_fitting.h>
#include <CGAL/Simple_cartesian.h>
#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "controlspace/error.h"
#include "controlspace/geometry/box.h"
#include "io/surface/surface_mesh.h"

namespace controlspace {
namespace {

using Kernel = CGAL::Simple_cartesian<double>;
using Fit = CGAL::Monge_via_jet_fitting<Kernel, Kernel, CGAL::Eigen_svd>;

constexpr std::size_t order = 2;
constexpr std::size_t coefficients = (order + 1) * (order + 2) / 2;

/// Vertices around vertex `i`, itself first, ring by ring.
void gather(const SurfaceMesh& mesh, std::uint32_t i, int rings,
            std::vector<std::uint32_t>& found) {
    found.assign(1, i);
    std::size_t ring_begin = 0;
    for (int ring = 0; ring < rings; ++ring) {
        const std::size_t ring_end = found.size();
        for (std::size_t k = ring_begin; k < ring_end; ++k) {
            for (std::size_t n = mesh.first[found[k]]; n < mesh.first[found[k] + 1]; ++n) {
                const std::uint32_t next = mesh.neighbours[n];
                if (std::find(found.begin(), found.end(), next) == found.end()) {
                    found.push_back(next);
                }
            }
        }
        ring_begin = ring_end;
    }
}

/// The jet at vertex `i`, from two rings around it; from more where these do not determine it, as
/// they do not where all lie on two lines.
Fit::Monge_form form_at(const SurfaceMesh& mesh, std::uint32_t i, const std::string& name) {
    constexpr int fewest_rings = 2, most_rings = 4;
    constexpr double well_determined = 1e4;
    std::vector<std::uint32_t> around;
    for (int rings = fewest_rings; rings <= most_rings; ++rings) {
        gather(mesh, i, rings, around);
        if (around.size() < coefficients) continue;
        std::vector<Kernel::Point_3> points;
        for (const std::uint32_t k : around) {
            const Point& p = mesh.vertices[k];
            points.emplace_back(p.x(), p.y(), p.z());
        }
        Fit fit;
        const Fit::Monge_form form = fit(points.begin(), points.end(), order, order);
        if (fit.condition_number() < well_determined) return form;
    }
    const Point& p = mesh.vertices[i];
    throw InputError(fmt::format(
        "{}: the {} vertices around {} {} {} do not say how the surface is curved: give "
        "smaller triangles there",
        name, around.size(), p.x(), p.y(), p.z()));
}

Vector vector_of(const Kernel::Vector_3& v) { return {v.x(), v.y(), v.z()}; }

struct Bounds {
    double h_min, h_max;
};

Bounds bounds_of(const std::filesystem::path& path, const CurvatureSizes& sizes,
                 const SurfaceMesh& mesh) {
    if (!(sizes.angle > 0 && sizes.angle <= 180)) {
        throw InputError(fmt::format("an angle of {}: give one of up to 180", sizes.angle));
    }
    Box extent{mesh.vertices.front(), mesh.vertices.front()};
    for (const Point& p : mesh.vertices) {
        extent = {extent.low.cwiseMin(p), extent.high.cwiseMax(p)};
    }
    const double diagonal = extent.edges().norm();
    const Bounds bounds{sizes.h_min != 0 ? sizes.h_min : 1e-3 * diagonal,
                        sizes.h_max != 0 ? sizes.h_max : 0.1 * diagonal};
    if (!is_length(bounds.h_min) || !is_length(bounds.h_max) || bounds.h_min > bounds.h_max) {
        throw InputError(fmt::format(
            "{}: lengths from {} to {}: give other bounds (--surface-h-min, --surface-h-max)",
            path.string(), bounds.h_min, bounds.h_max));
    }
    return bounds;
}

}  // namespace

std::vector<PointSource> read_surface_sources(const std::filesystem::path& path,
                                              const CurvatureSizes& sizes) {
    const SurfaceMesh mesh = read_surface_mesh(path);
    const Bounds bounds = bounds_of(path, sizes, mesh);
    // Chord of the circle of radius 1.
    const double chord = 2 * std::sin(sizes.angle / 2 * std::numbers::pi / 180);
    const auto length = [&](double curvature) {
        return std::clamp(chord / std::abs(curvature), bounds.h_min, bounds.h_max);
    };

    const auto source_at = [&](std::uint32_t i) {
        const Fit::Monge_form form = form_at(mesh, i, path.string());
        const double h1 = length(form.principal_curvatures(0));
        const double h2 = length(form.principal_curvatures(1));
        Eigen::Matrix3d frame;
        frame << vector_of(form.maximal_principal_direction()),
            vector_of(form.minimal_principal_direction()), vector_of(form.normal_direction());
        return PointSource{mesh.vertices[i], metric_from_frame({h1, h2, std::min(h1, h2)}, frame)};
    };
    std::vector<PointSource> sources(mesh.vertices.size());
    constexpr std::size_t vertices_per_task = 256;
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, sources.size(), vertices_per_task),
                      [&](const tbb::blocked_range<std::size_t>& range) {
                          for (std::size_t i = range.begin(); i < range.end(); ++i) {
                              sources[i] = source_at(static_cast<std::uint32_t>(i));
                          }
                      });
    return sources;
}

}  // namespace controlspace
