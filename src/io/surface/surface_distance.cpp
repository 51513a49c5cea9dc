// SPDX-License-Identifier: Apache-2.0
#include "io/surface/surface_distance.h"

#include <cmath>
#include <memory>

#include "io/surface/triangle_tree.h"

namespace controlspace {
namespace {

struct Search {
    explicit Search(const SurfaceMesh& mesh) : triangles(triangles_of(mesh)) {
        // Here, as queries build both too and several threads may begin them.
        tree.build();
        tree.accelerate_distance_queries();
    }
    const Triangles triangles;
    TriangleTree tree{triangles.begin(), triangles.end()};
};

}  // namespace

DistanceField surface_distance(const SurfaceMesh& mesh) {
    constexpr std::size_t most = 10000;
    DistanceField field;
    field.box = bounding_box(mesh.vertices, 0);
    const std::size_t step = 1 + mesh.vertices.size() / most;
    for (std::size_t i = 0; i < mesh.vertices.size(); i += step) {
        field.places.push_back(mesh.vertices[i]);
    }
    field.distance = [search = std::make_shared<const Search>(mesh)](const Point& x) {
        return std::sqrt(search->tree.squared_distance(point_of(x)));
    };
    return field;
}

}  // namespace controlspace
