// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

#include "controlspace/geometry/box.h"
#include "controlspace/mesh/tet_mesh.h"
#include "controlspace/metric/metric.h"

namespace controlspace {

inline const Box unit_box{Point::Zero(), Point::Ones()};

/// n x n x n cells of the unit box, each cut into the six tetrahedra around its diagonal.
inline TetMesh kuhn_mesh(VertexIndex n) {
    TetMesh mesh;
    const VertexIndex m = n + 1;
    for (VertexIndex i = 0; i < m * m * m; ++i) {
        mesh.vertices.push_back(Point(i % m, i / m % m, i / (m * m)) / n);
    }
    for (VertexIndex cell = 0; cell < n * n * n; ++cell) {
        const VertexIndex first = cell % n + m * (cell / n % n + m * (cell / (n * n)));
        std::array<VertexIndex, 3> steps{1, m, m * m};
        do {
            Tetrahedron tet{first};
            for (std::size_t k = 0; k < 3; ++k) tet[k + 1] = tet[k] + steps[k];
            mesh.tets.push_back(tet);
        } while (std::next_permutation(steps.begin(), steps.end()));
    }
    turn_upright(mesh);
    return mesh;
}

/// Lengths that grow away from the sphere of radius 0.8, as the exact field of sources on it.
inline Metric around_sphere(const Point& p, double h) {
    return Metric::isotropic(h + std::log(1.25) * std::abs(p.norm() - 0.8));
}

/// Six numbers that all differ and vary.
inline Metric skew_metric(const Point& p) {
    return {0.30 + 0.05 * std::sin(2 * p.x()),
            0.40 + 0.05 * std::cos(3 * p.y()),
            0.50 + 0.05 * std::sin(p.z()),
            0.02 + 0.01 * p.x(),
            -0.03 + 0.01 * p.y(),
            0.05 + 0.01 * p.z()};
}

/// Total area of the triangles.
inline double area(const TetMesh& mesh) {
    double sum = 0;
    for (const Triangle& t : mesh.triangles) {
        const Point& a = mesh.vertices[t[0]];
        sum += 0.5 * (mesh.vertices[t[1]] - a).cross(mesh.vertices[t[2]] - a).norm();
    }
    return sum;
}

}  // namespace controlspace
