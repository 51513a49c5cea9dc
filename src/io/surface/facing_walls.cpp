// SPDX-License-Identifier: Apache-2.0
#include "io/surface/facing_walls.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "io/surface/triangle_tree.h"

namespace controlspace {

namespace {
double cosine(double degrees) { return std::cos(degrees * std::numbers::pi / 180); }
}  // namespace

struct FacingWalls::Tree {
    const SurfaceMesh& mesh;
    const SmoothPatches& patches;
    const Triangles triangles = triangles_of(mesh);
    TriangleTree tree{triangles.begin(), triangles.end()};

    std::size_t index(Triangles::const_iterator triangle) const {
        return static_cast<std::size_t>(triangle - triangles.begin());
    }

    bool are_neighbours(std::size_t a, std::size_t b) const {
        const auto& fans = patches.fan_of[b];
        return std::ranges::find_first_of(patches.fan_of[a], fans) != patches.fan_of[a].end();
    }

    /// In the direction of `ray`, a unit vector.
    double distance(const Point& place, const Vector& ray, std::uint32_t t) const {
        constexpr double infinity = std::numeric_limits<double>::infinity();
        const double touching = 4 * rounding(mesh);
        const auto hit = tree.first_intersection(
            Kernel::Ray_3(point_of(place + touching * ray),
                          point_of(place + (touching + mesh.diagonal) * ray)),
            [&](Triangles::const_iterator other) { return are_neighbours(index(other), t); });
        if (!hit) return infinity;
        const auto* at = boost::get<Kernel::Point_3>(&hit->first);
        const auto wall = index(hit->second);
        static const double parallel = cosine(30), slender = cosine(20);
        if (at == nullptr) return infinity;
        const double cosine_there = std::abs(patches.normals[wall].dot(ray));
        if (cosine_there < parallel || (cosine_there < slender && patches.meet(t, wall))) {
            return infinity;
        }
        return (Point(at->x(), at->y(), at->z()) - place).norm();
    }
};

FacingWalls::FacingWalls(const SurfaceMesh& mesh, const SmoothPatches& patches)
    : tree_(new Tree{mesh, patches}) {
    tree_->tree.build();  // here, as queries build it too and several threads may begin them
}

FacingWalls::~FacingWalls() = default;

double FacingWalls::distance(const Point& place, std::uint32_t t) const {
    const Vector& normal = tree_->patches.normals[t];
    return std::min(tree_->distance(place, normal, t), tree_->distance(place, -normal, t));
}

}  // namespace controlspace
