// SPDX-License-Identifier: Apache-2.0
// Curvatures of CAD parts, which are exact, against closed forms. Files are Gmsh's.
#include "gmsh/cad_surface.h"

#include <gmsh.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "controlspace/metric/metric.h"
#include "gmsh/gmsh_session.h"
#include "io/surface/surface_sources.h"
#include "sources/files.h"

namespace controlspace::cad_surface_test {

namespace occ = gmsh::model::occ;

namespace {

/// A file of a part that `make` makes, turned and moved away from the origin, then enlarged.
class PartFile {
public:
    PartFile(const std::string& name, const std::function<void()>& make, double scale = 1)
        : path_(folder_.path() / name), scale_(scale) {
        in_gmsh_session(1, [&] {
            make();
            std::vector<std::pair<int, int>> all;
            occ::getEntities(all, 3);
            const Vector& a = turn_.axis();
            occ::rotate(all, 0, 0, 0, a.x(), a.y(), a.z(), turn_.angle());
            occ::translate(all, shift_.x(), shift_.y(), shift_.z());
            occ::dilate(all, 0, 0, 0, scale, scale, scale);
            occ::synchronize();
            gmsh::write(path_.string());
        });
    }

    const std::filesystem::path& path() const { return path_; }
    /// A place and a direction as `make` has them.
    Point place(const Point& p) const { return turn_.inverse() * Vector(p / scale_ - shift_); }
    Vector direction(const Vector& v) const { return turn_.inverse() * v; }

private:
    const Vector shift_{0.3, -2, 1};
    const Eigen::AngleAxisd turn_{0.7, Vector(1, 2, -1).normalized()};
    const ScratchDirectory folder_;
    const std::filesystem::path path_;
    const double scale_;
};

constexpr double flat = 1e3;  ///< the radius of a plane

/// Lengths are radii: the chord of 60 degrees; no bounds, no walls.
CurvatureSizes radii(double scale, bool isotropic = false) {
    return {.angle = 60,
            .elements_across = 1e-3,
            .isotropic = isotropic,
            .h_min = 1e-3 * scale,
            .h_max = flat * scale};
}

/// Principal radii at a place, and the direction of the smaller one; 0 for places left out.
struct Radii {
    double small = 0, large = 0;
    Vector along_small{0, 0, 0};
};

Vector around_z(const Point& p) { return Vector(-p.y(), p.x(), 0).normalized(); }
double from_z(const Point& p) { return std::hypot(p.x(), p.y()); }

struct Shape {
    std::string name;
    void (*make)();
    Radii (*radii)(const Point&);
};

std::vector<Shape> shapes() {
    return {
        {"sphere", [] { occ::addSphere(0, 0, 0, 2); },
         [](const Point& p) {
             CHECK(p.norm() == Approx(2));
             return Radii{2, 2};
         }},
        {"cylinder", [] { occ::addCylinder(0, 0, 0, 0, 0, 5, 1.5); },
         [](const Point& p) {
             return from_z(p) > 1.499 ? Radii{1.5, flat, around_z(p)} : Radii{flat, flat};
         }},
        {"cone", [] { occ::addCone(0, 0, 0, 0, 0, 2, 1.5, 0); },
         [](const Point& p) {
             const double r = from_z(p);
             if (p.z() > 1.9) return Radii{};
             return p.z() > 1e-3 || r > 1.499 ? Radii{1.25 * r, flat, around_z(p)}
                                              : Radii{flat, flat};
         }},
        {"torus", [] { occ::addTorus(0, 0, 0, 3, 1); },
         [](const Point& p) {
             const double r = from_z(p);
             const Vector out(p.x() / r, p.y() / r, 0);
             const Vector normal = (r - 3) * out + p.z() * Vector::UnitZ();
             return Radii{1, std::min(r / std::abs(r - 3), flat), normal.cross(around_z(p))};
         }},
        {"ellipsoid of revolution",
         [] {
             occ::addSphere(0, 0, 0, 1);
             occ::dilate({{3, 1}}, 0, 0, 0, 1, 1, 2);
         },
         [](const Point& p) {
             const double r = from_z(p);
             if (r < 0.05) return Radii{};
             // Across the meridian the distance along the normal to the axis.
             const double around = std::hypot(r, p.z() / 4), along = 4 * around * around * around;
             if (std::abs(around - along) < 0.01) return Radii{};
             const Vector meridian = around_z(p).cross(Vector(p.x(), p.y(), p.z() / 4));
             return around < along ? Radii{around, along, around_z(p)}
                                   : Radii{along, around, meridian.normalized()};
         }},
    };
}

}  // namespace

TEST_CASE("radii of curvature of CAD parts and their directions are exact") {
    struct File {
        std::string name;
        double scale;
    };
    const auto [name, scale] =
        GENERATE(values<File>({{"part.step", 1}, {"part.step", 1e-2}, {"part.brep", 250}}));
    const Shape shape = GENERATE(from_range(shapes()));
    CAPTURE(shape.name, name, scale);
    const PartFile part(name, shape.make, scale);
    const SurfaceMesh mesh = read_cad_surface(part.path());
    const std::size_t vertices = mesh.vertices.size();
    double worst = 0, worst_isotropic = 0, most_turned = 0;
    std::size_t seen = 0;
    const SurfaceSources tensors = surface_sources(mesh, radii(scale), part.path());
    const SurfaceSources lengths = surface_sources(mesh, radii(scale, true), part.path());
    CHECK(tensors.fitted == 0);
    for (std::size_t v = 0; v < vertices; ++v) {  // whose sources come first
        const Metric& metric = tensors.sources[v].metric;
        const Radii expected = shape.radii(part.place(mesh.vertices[v]));
        if (expected.small == 0) continue;
        ++seen;
        // The length across the surface is the smaller one, too.
        const EigenFrame found = eigen_frame(metric);
        worst = std::max({worst, std::abs(found.lengths[0] / scale / expected.small - 1),
                          std::abs(found.lengths[2] / scale / expected.large - 1)});
        worst_isotropic = std::max(
            worst_isotropic, std::abs(lengths.sources[v].metric.xx / scale / expected.small - 1));
        if (expected.large < 1.01 * expected.small) continue;
        const Vector along_large = part.direction(found.directions.col(2));
        most_turned = std::max(most_turned, std::abs(along_large.dot(expected.along_small)));
    }
    CHECK(seen > 40);
    CHECK(worst < 1e-6);
    CHECK(worst_isotropic < 1e-6);
    CHECK(most_turned < 1e-5);
}

TEST_CASE("a fillet has its radius all over, and the plates beside it have none") {
    constexpr double radius = 0.5, angle = 3;
    const PartFile part("part.step", [] {
        occ::addBox(0, 0, 0, 4, 3, 2);
        occ::synchronize();
        std::vector<double> uprights;
        std::vector<std::pair<int, int>> edges, filleted;
        gmsh::model::getEntities(edges, 1);
        std::vector<int> along_z;
        for (const auto& [dimension, tag] : edges) {
            std::vector<double> low, high;
            gmsh::model::getParametrizationBounds(1, tag, low, high);
            gmsh::model::getValue(1, tag, {low[0], high[0]}, uprights);
            if (uprights[2] != uprights[5]) along_z.push_back(tag);
        }
        REQUIRE(along_z.size() == 4);
        occ::fillet({1}, along_z, {radius}, filleted);
    });
    CurvatureSizes sizes = radii(1, true);
    sizes.angle = angle;  // so fine that there are sources inside triangles, too
    const SurfaceMesh mesh = read_cad_surface(part.path());
    const SurfaceSources found = surface_sources(mesh, sizes, part.path());
    CHECK(found.fitted == 0);
    const double fine = 2 * std::sin(angle / 360 * M_PI) * radius;
    std::size_t inside = 0;
    bool any_flat = false;
    for (std::size_t i = 0; i < found.sources.size(); ++i) {
        const auto& [place, metric, own_growth] = found.sources[i];
        const Point p = part.place(place);
        const bool on_fillet = std::min(p.x(), 4 - p.x()) < radius + 1e-6 &&
                               std::min(p.y(), 3 - p.y()) < radius + 1e-6;
        const bool on_top = std::min(p.z(), 2 - p.z()) < 1e-6;
        CAPTURE(p.transpose());
        if (i >= mesh.vertices.size()) {
            ++inside;
            CHECK(on_fillet);
            CHECK_FALSE(on_top);
        }
        any_flat |= !on_fillet;
        // Tops are flat up to their rim, which the fillets share.
        if (on_fillet && on_top && metric.xx > 1) continue;
        CHECK(metric.xx == Approx(on_fillet ? fine : flat).epsilon(1e-6));
    }
    CHECK(inside > 1000);
    CHECK(any_flat);
}

TEST_CASE("the apex of a CAD cone has the smallest length") {
    const PartFile part("part.step", [] { occ::addCone(0, 0, 0, 0, 0, 2, 1.5, 0); });
    const SurfaceMesh mesh = read_cad_surface(part.path());
    const CurvatureSizes sizes = radii(1, true);
    const SurfaceSources found = surface_sources(mesh, sizes, part.path());
    CHECK(found.fitted == 0);
    const auto apex = std::ranges::max_element(
        found.sources, {}, [&](const PointSource& s) { return part.place(s.position).z(); });
    CHECK(part.place(apex->position).z() == Approx(2));
    CHECK(apex->metric.xx == Approx(sizes.h_min));
}

TEST_CASE("curvatures that a CAD part does not give are fitted, and counted") {
    const PartFile part("part.step", [] { occ::addSphere(0, 0, 0, 2); });
    SurfaceMesh mesh = read_cad_surface(part.path());
    const std::uint32_t somewhere = mesh.triangles.front()[0];
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        for (std::size_t k = 0; k < 3; ++k) {
            if (mesh.triangles[t][k] == somewhere) mesh.curvature_of[t][k] = SurfaceMesh::unknown;
        }
    }
    const SurfaceSources found = surface_sources(mesh, radii(1, true), part.path());
    CHECK(found.fitted == 1);
    CHECK(found.sources[somewhere].metric.xx == Approx(2).epsilon(0.02));
    CHECK(found.sources[somewhere].metric.xx != Approx(2).epsilon(1e-9));
}

}  // namespace controlspace::cad_surface_test
