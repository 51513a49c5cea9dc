// SPDX-License-Identifier: Apache-2.0
// Lengths across walls and gaps.
#include <catch2/catch.hpp>
#include <cmath>

#include "controlspace/io/read_surface_sources.h"
#include "export/surfaces.h"
#include "io/surface/surface_mesh.h"
#include "io/surface/surface_sources.h"
#include "sources/files.h"

namespace controlspace::surface_walls_test {
namespace {

std::vector<PointSource> sources_of(const Surface& surface, const CurvatureSizes& sizes) {
    const ScratchDirectory scratch;
    return read_surface_sources(scratch.file("s.off", off_text(surface)), sizes).sources;
}

/// Sources on the plane where x[axis] = `at`, away from its rim: those inside `inside`.
std::vector<PointSource> within(const std::vector<PointSource>& sources,
                                const Eigen::AlignedBox3d& inside) {
    std::vector<PointSource> found;
    for (const PointSource& s : sources) {
        if (inside.contains(s.position)) found.push_back(s);
    }
    return found;
}

double along(const Metric& m, const Vector& direction) { return 1 / metric_length(m, direction); }

/// Isotropic lengths at a place, growing by 0.25 a unit of distance from every source: brute force.
double length_at(const std::vector<PointSource>& sources, const Point& p) {
    double length = 1e300;
    for (const PointSource& s : sources) {
        length = std::min(length, s.metric.xx + 0.25 * (p - s.position).norm());
    }
    return length;
}

/// A box from the origin whose top and bottom are fans around a vertex above and below `inside`.
Surface box_with_fans(const Vector& edges, const Point& inside) {
    Surface s;
    for (const double z : {0., edges.z()}) {
        const double x = edges.x(), y = edges.y();
        for (const Point& p : {Point(0, 0, z), Point(x, 0, z), Point(x, y, z), Point(0, y, z),
                               Point(inside.x(), inside.y(), z)}) {
            s.vertices.push_back(p);
        }
    }
    for (const std::size_t i : {0, 1, 2, 3}) {
        const std::size_t j = (i + 1) % 4;
        s.triangles.push_back({j, i, 4});
        s.triangles.push_back({i + 5, j + 5, 9});
        s.triangles.push_back({i, j, j + 5});
        s.triangles.push_back({i, j + 5, i + 5});
    }
    return s;
}

/// The same where the flat triangle at y = 0 has flat ones at its other sides, too.
Surface box_with_chains(const Vector& edges, const Point& inside) {
    Surface s = box_with_fans(edges, inside);
    for (const std::size_t base : {0, 5}) {
        for (const auto& [end, far] : {std::pair(0, 3), {1, 2}}) {
            const std::size_t a = base + std::size_t(end), b = base + 4,
                              c = base + std::size_t(far);
            std::erase_if(s.triangles, [&](const auto& t) {
                return std::ranges::is_permutation(t, std::array{a, b, c});
            });
            const std::size_t middle = s.vertices.size();
            s.vertices.push_back((s.vertices[a] + s.vertices[b]) / 2 +
                                 Vector(0, inside.y() / 20, 0));
            s.triangles.insert(s.triangles.end(), {{a, b, middle}, {b, c, middle}, {c, a, middle}});
        }
    }
    return s;
}

/// A plate with a fin of thickness 0.004 on it.
Surface plate_with_fin(std::size_t n) {
    Surface surface = box({0, 0, 0}, {1, 1, 0.2}, n);
    surface += box({0, 0.498, 0.2}, {1, 0.502, 0.5}, n);
    return surface;
}

}  // namespace

TEST_CASE("a fin on a plate has lengths across it, and stays long along") {
    const std::size_t n = GENERATE(1, 4, 16);
    const double across = GENERATE(1.0, 2.0);
    const auto sources = sources_of(plate_with_fin(n), {.elements_across = across, .h_min = 1e-4});
    const auto fin = within(sources, {Point(0.1, 0.45, 0.25), Point(0.9, 0.55, 0.45)});
    CHECK(fin.size() > 8);
    for (const auto& [p, metric, own_growth] : fin) {
        CHECK(along(metric, Vector::UnitY()) == Approx(0.004 / across).epsilon(0.01));
        CHECK(along(metric, Vector::UnitX()) > 0.1);
        CHECK(along(metric, Vector::UnitZ()) > 0.1);
    }
    for (const auto& [p, metric, own_growth] :
         within(sources, {Point(0.1, 0.1, -0.1), Point(0.9, 0.4, 0.1)})) {
        CHECK(along(metric, Vector::UnitX()) > 0.1);
        CHECK(along(metric, Vector::UnitZ()) == Approx(0.2 / across).epsilon(0.01).margin(0.06));
    }
}

TEST_CASE("isotropic lengths are the shortest of the anisotropic ones") {
    const Surface surface = plate_with_fin(2);
    const auto sources = sources_of(surface, {.isotropic = true});
    const auto fin = within(sources, {Point(0.1, 0.45, 0.25), Point(0.9, 0.55, 0.45)});
    // Every place of the fin is within two lengths of a source.
    CHECK(double(fin.size()) > 0.5 * 0.8 * 0.2 / (0.004 * 0.004));
    for (const PointSource& s : sources) REQUIRE(is_isotropic(s.metric));
    for (const auto& [p, metric, own_growth] : fin) CHECK(metric.xx == Approx(0.002).epsilon(0.01));
}

TEST_CASE("a gap has lengths across it, on both sides, whatever the orientation") {
    const double gap = GENERATE(0.1, 0.02, 0.005);
    const std::size_t n = GENERATE(1, 3, 10);
    Surface surface = box({0, 0, 0}, {1, 1, 1}, n);
    surface += box({0, 0, 1 + gap}, {1, 1, 2 + gap}, n + 1);
    const Eigen::Affine3d map = somewhere(10);
    const Vector normal = map.linear().col(2).normalized();
    int seen = 0;
    for (const auto& [q, metric, own_growth] :
         sources_of(transformed(surface, map), {.elements_across = 3, .h_min = 0.01, .h_max = 2})) {
        const Point p = map.inverse() * q;
        const bool beside_gap = std::abs(p.z() - 1 - gap / 2) < 0.501 * gap;
        const bool inside = p.head(2).minCoeff() > 0.05 && p.head(2).maxCoeff() < 0.95;
        if (!inside) continue;
        CAPTURE(p.x(), p.y(), p.z());
        CHECK(along(metric, normal) == Approx(beside_gap ? 10 * gap / 3 : 2).epsilon(0.01));
        seen += beside_gap;
    }
    CHECK(seen >= 8);
}

TEST_CASE("a shell of two spheres has its thickness, and follows both curvatures") {
    Surface shell = sphere(48, 24);
    shell += transformed(sphere(40, 20), Eigen::Affine3d(Eigen::Scaling(0.98)));
    for (const auto& [p, metric, own_growth] : sources_of(shell, {.h_min = 1e-4})) {
        if (std::abs(p.z()) > 0.7) continue;
        const Vector normal = p.normalized();
        CHECK(along(metric, normal) == Approx(0.01).epsilon(0.2));
        const double around = along(metric, Vector(-p.y(), p.x(), 0).normalized());
        CHECK(around == Approx(chord(15) * p.norm()).epsilon(0.05));
    }
}

TEST_CASE("a plate has its thickness along its edges, where flat triangles meet its rim") {
    // Down to an angle of 179.98 degrees, which rounding of floats tilts by a degree.
    const double height = GENERATE(30., 8.5, 1., 0.01, 0.0005);
    CAPTURE(height);
    const auto make = GENERATE(box_with_fans, box_with_chains);
    const Surface plate = make({100, 60, 2}, {50, height, 0});
    const Eigen::Affine3d map = somewhere(GENERATE(1., 10.));
    const double scale = map.linear().col(0).norm();
    auto turned = transformed(plate, map);
    if (GENERATE(false, true)) {  // as binary .stl has them
        for (Point& p : turned.vertices) p = p.cast<float>().cast<double>();
    }
    const auto sources = sources_of(turned, {.isotropic = true});
    double longest = 0;
    for (double x = 0; x <= 100; x += 2.5) {
        for (const double z : {0, 2}) {
            for (const double y : {0., 0.5, 2., 30., 60.}) {
                longest = std::max(longest, length_at(sources, map * Point(x, y, z)) / scale);
            }
        }
    }
    CHECK(longest < 1.35);  // two lengths between sources, along which they grow
}

TEST_CASE("no length is below h_min where walls at an angle meet, and those raised are counted") {
    // A bar whose sides are 45 degrees from each other, thinner than two lengths.
    Eigen::Affine3d shear = Eigen::Affine3d::Identity();
    shear.linear()(0, 1) = GENERATE(1., 0.3, -1.5);
    const std::size_t n = GENERATE(1, 4);
    const Surface bar = transformed(box({0, 0, 0}, {0.1, 0.1, 4}, n), somewhere(1) * shear);
    const bool isotropic = GENERATE(false, true);
    const ScratchDirectory scratch;
    const auto path = scratch.file("b.off", off_text(bar));
    const CurvatureSizes sizes{.isotropic = isotropic, .h_min = 0.1, .h_max = 1};
    const SurfaceSources found = read_surface_sources(path, sizes);
    double finest = 1e300;
    for (const PointSource& s : found.sources) {
        finest = std::min(finest, eigen_frame(s.metric).lengths[0]);
    }
    CHECK(finest >= 0.1 * (1 - 1e-12));
    CHECK(finest <= 0.1 * (1 + 1e-12));
    CHECK(found.h_min == 0.1);
    // All of them: the ends, 4 apart, have the sides' walls at their rim, and are flat inside.
    CHECK(found.raised > 0);
    CHECK(found.raised <= found.sources.size());
    CHECK(read_surface_sources(path, {.h_min = 0.01, .h_max = 1}).raised == 0);
}

TEST_CASE("lengths of fillets and holes that are raised to h_min are counted") {
    const ScratchDirectory scratch;
    const auto path = scratch.file("c.off", off_text(cone(1, 1, 4, 40, 20)));
    const SurfaceSources found = read_surface_sources(path, {.h_min = 0.4, .h_max = 5});
    CHECK(found.raised == found.sources.size());
    CHECK(read_surface_sources(path, {.h_min = 0.2, .h_max = 5}).raised == 0);
}

TEST_CASE("a flat triangle of a plate has the plate's normal beside a flat chamfer, too") {
    // Within the angle of a crease of the top, which goes on smoothly over its rim.
    Surface plate = box_with_fans({100, 60, 2}, {50, 8.5, 0});
    const double out = 2 / std::tan(25 * pi / 180);
    for (const std::size_t i : {0, 1, 2, 3}) {
        Point& p = plate.vertices[i];
        p += out * Vector(p.x() > 0 ? 1 : -1, p.y() > 0 ? 1 : -1, 0);
    }
    std::size_t seen = 0;
    for (const PointSource& s : sources_of(plate, {.isotropic = true})) {
        const Point& p = s.position;
        const double beside = std::min(p.x(), 100 - p.x());
        if (p.z() != 2 || p.y() < 0.1 || p.y() > 8.4 * beside / 50) continue;
        ++seen;
        CHECK(s.metric.xx == Approx(1).epsilon(0.01));
    }
    CHECK(seen > 100);
}

TEST_CASE("flanks of a sharp edge are a wall within 20 degrees, others within 30") {
    struct Tooth {
        double angle, land;
        bool is_wall;
    };
    const auto [angle, land, is_wall] = GENERATE(values<Tooth>({{4, 0, true},
                                                                {18, 0, true},
                                                                {22, 0, false},
                                                                {28, 0, false},
                                                                {4, 0.1, true},
                                                                {22, 0.1, true},
                                                                {28, 0.1, true},
                                                                {32, 0.1, false}}));
    const std::size_t n = GENERATE(1, 12);
    CAPTURE(angle, land, n);
    // A prism along y, 1 high; z = 1 is the tip.
    const double foot = land / 2 + std::tan(angle / 2 * pi / 180);
    Surface tooth;
    for (const double side : {-1., 1.}) {
        tooth += patch({n, n}, [&](double u, double v) {
            return Point(side * (foot + u * (land / 2 - foot)), 2 * v, u);
        });
    }
    if (land > 0) {
        tooth +=
            patch({1, n}, [&](double u, double v) { return Point(land * (u - 0.5), 2 * v, 1); });
    }
    const auto sources = sources_of(transformed(tooth, somewhere(1)),
                                    {.isotropic = true, .h_min = 1e-2, .h_max = 5});
    const Eigen::Affine3d back = somewhere(1).inverse();
    double finest = 1e300;
    for (const PointSource& s : sources) {
        const double z = (back * s.position).z();
        if (z > 0.45 && z < 0.55) finest = std::min(finest, eigen_frame(s.metric).lengths[0]);
    }
    if (!is_wall) {
        CHECK(finest > 4.9);
    } else {
        // Along the normal of one flank to the other one, half of it.
        const double z = 0.5, x = land / 2 + (1 - z) * std::tan(angle / 2 * pi / 180);
        const double thickness =
            2 * x * std::cos(angle / 2 * pi / 180) / std::cos(angle * pi / 180);
        CHECK(finest == Approx(thickness / 2).epsilon(0.15));
    }
}

TEST_CASE("random rays from a plate ask for its thickness, whatever its sources") {
    const double scale = GENERATE(1., 10.);
    const Eigen::Affine3d map = somewhere(scale);
    const ScratchDirectory scratch;
    const auto path =
        scratch.file("p.off", off_text(transformed(box_with_fans({100, 60, 2}, {50, 9, 0}), map)));
    const SurfaceMesh mesh = read_surface_mesh(path);
    constexpr std::size_t rays = 4000;
    const auto requests = wall_requests(mesh, {.elements_across = 2}, rays, 1, path);
    double across = 0;
    Point sum = Point::Zero();
    for (const WallRequest& wall : requests) {
        const Vector normal = map.linear().inverse() * wall.normal * scale;
        const Point place = map.inverse() * wall.place;
        if (std::abs(normal.z()) < 0.5) {
            CHECK(wall.length == Approx(0.1 * mesh.diagonal));  // through the plate's plane
            continue;
        }
        CHECK(std::abs(normal.z()) == Approx(1));
        CHECK(std::min(std::abs(place.z()), std::abs(place.z() - 2)) < 1e-6);
        CHECK(wall.length == Approx(scale));
        sum += place;
        ++across;
    }
    // By area, within four standard deviations; all others go through the plate's plane.
    CHECK(requests.size() == rays);
    CHECK(across / rays == Approx(12000. / 12640).margin(0.014));
    CHECK(sum.x() / across == Approx(50).margin(4 * 100 / std::sqrt(12 * across)));
    CHECK(sum.y() / across == Approx(30).margin(4 * 60 / std::sqrt(12 * across)));
    const auto again = wall_requests(mesh, {.elements_across = 2}, rays, 1, path);
    CHECK(again.back().place == requests.back().place);
    // Raised to h_min, and none where nothing is opposite.
    CHECK(wall_requests(mesh, {.h_min = 3 * scale}, 100, 2, path).front().length ==
          Approx(3 * scale));
    const auto sheet = scratch.file(
        "s.off", off_text(patch({2, 2}, [](double u, double v) { return Point(u, v, 0); })));
    CHECK(wall_requests(read_surface_mesh(sheet), {}, 100, 1, sheet).empty());
}

TEST_CASE("walls that touch, and surfaces at an angle to each other, are no gaps") {
    Surface surface = box({0, 0, 0}, {1, 1, 1}, 1);
    surface += box({0.1, 0.1, 1}, {0.9, 0.9, 2}, 2);  // stands on it
    for (const PointSource& s : sources_of(surface, {.elements_across = 1, .h_max = 0.5})) {
        CHECK(eigen_frame(s.metric).lengths[0] == Approx(0.5));
    }
    // A wedge of 60 degrees.
    const Surface wedge = patch({2, 6}, [](double u, double v) {
        const double x = 2 * u - 1;
        return Point(std::abs(x), v, x * std::tan(pi / 6));
    });
    for (const PointSource& s : sources_of(wedge, {.elements_across = 10, .h_max = 0.2})) {
        CHECK(eigen_frame(s.metric).lengths[0] == Approx(0.2));
    }
}

}  // namespace controlspace::surface_walls_test
