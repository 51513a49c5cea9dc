// SPDX-License-Identifier: Apache-2.0
#include "controlspace/mesh/tet_mesh.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <utility>

namespace controlspace {

std::vector<Edge> edges_of(const TetMesh& mesh) {
    // Sorted as one number each: half the time of sorting pairs.
    std::vector<std::uint64_t> keys;
    keys.reserve(mesh.tets.size() * tet_edges.size());
    for (const Tetrahedron& tet : mesh.tets) {
        for (const auto& [a, b] : tet_edges) {
            const auto [low, high] = std::minmax(tet[a], tet[b]);
            keys.push_back(std::uint64_t{low} << 32 | high);
        }
    }
    std::sort(keys.begin(), keys.end());
    keys.erase(std::unique(keys.begin(), keys.end()), keys.end());
    std::vector<Edge> edges(keys.size());
    std::transform(keys.begin(), keys.end(), edges.begin(), [](std::uint64_t key) {
        return Edge{static_cast<VertexIndex>(key >> 32), static_cast<VertexIndex>(key)};
    });
    return edges;
}

double signed_volume(const Point& a, const Point& b, const Point& c, const Point& d) {
    return (b - a).cross(c - a).dot(d - a) / 6;
}

double signed_volume(const TetMesh& mesh, const Tetrahedron& tet) {
    const auto& v = mesh.vertices;
    return signed_volume(v[tet[0]], v[tet[1]], v[tet[2]], v[tet[3]]);
}

void turn_upright(TetMesh& mesh) {
    for (Tetrahedron& tet : mesh.tets) {
        if (signed_volume(mesh, tet) < 0) std::swap(tet[2], tet[3]);
    }
}

double volume(const TetMesh& mesh) {
    double sum = 0;
    for (const Tetrahedron& tet : mesh.tets) sum += signed_volume(mesh, tet);
    return sum;
}

}  // namespace controlspace
