// SPDX-License-Identifier: Apache-2.0
#include "controlspace/sources/scattered_surfaces.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <optional>
#include <unordered_map>

#include "geometry/random_fractions.h"

namespace controlspace {

namespace {

struct SurfacePlace {
    Point position;
    Vector normal;
};

// Around the origin.
class Sphere {
public:
    explicit Sphere(double radius) : radius_(radius) {}

    double area() const { return 4 * std::numbers::pi * radius_ * radius_; }

    SurfacePlace draw(RandomFractions& fraction) const {
        // Marsaglia 1972: from a place in the unit disk, without an angle.
        double a = 0;
        double b = 0;
        double s = 1;
        while (s >= 1) {
            a = 2 * fraction() - 1;
            b = 2 * fraction() - 1;
            s = a * a + b * b;
        }
        const double c = 2 * std::sqrt(1 - s);
        return towards({a * c, b * c, 1 - 2 * s});
    }

    // `place` moved by the part of `step` that is along the surface.
    std::optional<SurfacePlace> move(const SurfacePlace& place, const Vector& step) const {
        const Vector along = step - step.dot(place.normal) * place.normal;
        return towards((place.position + along).normalized());
    }

private:
    SurfacePlace towards(const Vector& normal) const { return {radius_ * normal, normal}; }

    double radius_;
};

// The two planes of sample_planes.
class Planes {
public:
    explicit Planes(double slope)
        : slope_(slope),
          stretch_(std::sqrt(1 + slope * slope)),
          second_normal_(Vector(slope, -1, 0) / stretch_) {}

    double area() const { return 4 * (1 + stretch_); }

    SurfacePlace draw(RandomFractions& fraction) const {
        const bool first = fraction() * (1 + stretch_) < 1;
        const double u = 2 * fraction() - 1;
        const double v = 2 * fraction() - 1;
        if (first) return {{-0.5, u, v}, Vector::UnitX()};
        return {{u, -0.2 + slope_ * u, v}, second_normal_};
    }

    // Nothing where that leaves the plane's part of [-1,1]^3.
    std::optional<SurfacePlace> move(const SurfacePlace& place, const Vector& step) const {
        SurfacePlace moved = place;
        moved.position += step - step.dot(place.normal) * place.normal;
        if ((moved.position.array().abs() > 1).any()) return std::nullopt;
        return moved;
    }

private:
    double slope_;
    double stretch_;
    Vector second_normal_;
};

// Mean 0, variance 1: the sum of twelve fractions has variance 1 (Irwin and Hall), and takes no
// function that differs between machines.
double draw_normal(RandomFractions& fraction) {
    double sum = -6;
    for (int i = 0; i < 12; ++i) sum += fraction();
    return sum;
}

template <class Surface>
std::vector<SurfacePlace> draw_clustered(const Surface& surface, std::size_t count,
                                         RandomFractions& fraction) {
    std::vector<SurfacePlace> centres;
    centres.reserve(cluster_count);
    for (int i = 0; i < cluster_count; ++i) centres.push_back(surface.draw(fraction));
    const double spread = cluster_spread * std::sqrt(surface.area());
    std::vector<SurfacePlace> places;
    places.reserve(count);
    while (places.size() < count) {
        const auto& centre = centres[static_cast<std::size_t>(fraction() * cluster_count)];
        Vector step;
        for (Axis a = 0; a < 3; ++a) step[a] = spread * draw_normal(fraction);
        if (const auto place = surface.move(centre, step)) places.push_back(*place);
    }
    return places;
}

// Points of which no two are nearer to each other than `spacing`, by cubes of that edge.
// Coordinates must be less than 2^53 spacings from the origin.
class SpacedPlaces {
public:
    explicit SpacedPlaces(double spacing) : spacing_(spacing) {}

    // Adds `p`, unless a point is nearer to it than the spacing; returns whether it did.
    bool add(const Point& p) {
        const auto is_near = [&](const Point& other) { return (other - p).norm() < spacing_; };
        const Point cube = (p / spacing_).array().floor();
        std::vector<Point>& own = points_[key(cube)];
        if (std::ranges::any_of(own, is_near)) return false;  // most likely
        for (int i = 0; i < 27; ++i) {
            const Eigen::Vector3i step(i / 9 - 1, i / 3 % 3 - 1, i % 3 - 1);
            const auto beside = points_.find(key(cube + step.cast<double>()));
            if (beside == points_.end()) continue;
            if (std::ranges::any_of(beside->second, is_near)) return false;
        }
        own.push_back(p);
        return true;
    }

private:
    // Cubes of the same key share their points.
    static std::size_t key(const Point& cube) {
        std::size_t key = 0;
        for (const double i : cube) {
            key = (key ^ static_cast<std::size_t>(std::int64_t(i))) * 0x9e3779b97f4a7c15;
        }
        return key;
    }

    double spacing_;
    std::unordered_map<std::size_t, std::vector<Point>> points_;
};

// Throws darts, `count` being how many squares of edge `spacing` the surface has.
template <class Surface>
std::vector<SurfacePlace> draw_spaced(const Surface& surface, std::size_t count, double spacing,
                                      RandomFractions& fraction) {
    // Darts for each square: 0.60 of them stick; 0.70 would if one threw for ever.
    constexpr std::size_t darts = 16;
    SpacedPlaces spaced(spacing);
    std::vector<SurfacePlace> places;
    for (std::size_t i = 0; i < darts * count; ++i) {
        const SurfacePlace place = surface.draw(fraction);
        if (spaced.add(place.position)) places.push_back(place);
    }
    return places;
}

template <class Surface>
std::vector<SurfacePlace> draw(const Surface& surface, Sampling sampling, std::size_t count,
                               double spacing, std::uint64_t seed) {
    RandomFractions fraction(seed);
    if (sampling == Sampling::clustered) return draw_clustered(surface, count, fraction);
    if (sampling == Sampling::poisson) return draw_spaced(surface, count, spacing, fraction);
    std::vector<SurfacePlace> places;
    places.reserve(count);
    for (std::size_t i = 0; i < count; ++i) places.push_back(surface.draw(fraction));
    return places;
}

template <class Surface>
std::vector<PointSource> sources_at(const std::vector<SurfacePlace>& places, const Surface& s,
                                    const Point& origin) {
    const double along = s.h * s.s_a;
    std::vector<PointSource> sources;
    sources.reserve(places.size());
    for (const auto& [position, normal] : places) {
        sources.push_back({origin + position, layer_metric(normal, along * s.s_n, along)});
    }
    return sources;
}

}  // namespace

std::vector<PointSource> scatter_sphere(const SphereSampling& s, Sampling sampling,
                                        std::uint64_t seed) {
    std::vector<PointSource> in_rows = sample_sphere(s);
    if (sampling == Sampling::regular) return in_rows;
    return sources_at(draw(Sphere(s.radius), sampling, in_rows.size(), s.h * s.rho, seed), s,
                      s.centre);
}

std::vector<PointSource> scatter_planes(const PlanesSampling& s, Sampling sampling,
                                        std::uint64_t seed) {
    std::vector<PointSource> in_rows = sample_planes(s);
    if (sampling == Sampling::regular) return in_rows;
    return sources_at(draw(Planes(s.slope), sampling, in_rows.size(), s.h * s.rho, seed), s,
                      Point::Zero());
}

}  // namespace controlspace
