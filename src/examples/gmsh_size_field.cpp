// SPDX-License-Identifier: Apache-2.0
// A control space as the size field of a Gmsh program: sources request edge lengths at some points,
// and the control space gives them at every point.
#include <controlspace/space/make_control_space.h>
#include <gmsh.h>

#include <vector>

using namespace controlspace;

int main() {
    const std::vector<PointSource> sources{{Point(0.3, 0.2, 0), Metric::isotropic(0.02)},
                                           {Point(-1, -1, -1), Metric::isotropic(0.05)}};
    const auto space = make_control_space(
        "K_oV", sources, {.domain = {Point(-1, -1, -1), Point(1, 1, 1)}, .ratio = 1.25});

    gmsh::initialize();
    gmsh::model::occ::addBox(-1, -1, -1, 2, 2, 2);
    gmsh::model::occ::synchronize();
    gmsh::option::setNumber("Mesh.MeshSizeFromPoints", 0);
    gmsh::option::setNumber("Mesh.MeshSizeExtendFromBoundary", 0);
    // Gmsh makes edges longer than its size field: 0.77 times the length compensates. From 4.9 on a
    // sixth argument holds the other sizes; there are none here. Several threads may call this.
    gmsh::model::mesh::setSizeCallback([&](int, int, double x, double y, double z, auto...) {
        return 0.77 * space->length_at({x, y, z});
    });
    gmsh::model::mesh::generate(3);
    gmsh::write("mesh.msh");
    gmsh::finalize();
}
