#include "gmsh/cad_surface.h"

#include <fmt/format.h>
#include <gmsh.h>

#include <utility>
#include <vector>

#include "controlspace/error.h"
#include "controlspace/geometry/box.h"
#include "gmsh/gmsh_mesh.h"
#include "gmsh/gmsh_session.h"

namespace controlspace {

SurfaceMesh read_cad_surface(const std::filesystem::path& path) {
    if (!std::filesystem::is_regular_file(path)) {
        throw InputError(fmt::format("{}: no such file", path.string()));
    }
    constexpr double triangles_around = 36;
    constexpr int surfaces = 2;
    SurfaceMesh mesh;
    in_gmsh_session(1, [&] {
        std::vector<std::pair<int, int>> shapes;
        gmsh::model::occ::importShapes(path.string(), shapes);
        gmsh::model::occ::synchronize();
        gmsh::option::setNumber("Mesh.MeshSizeFromCurvature", triangles_around);
        gmsh::option::setNumber("Mesh.MeshSizeFromPoints", 0);
        gmsh::model::mesh::generate(surfaces);
        const GmshNodes nodes;
        mesh.vertices = nodes.places();
        mesh.triangles = nodes.elements<3>(GmshNodes::triangle);
    });
    if (mesh.triangles.empty()) {
        throw InputError(fmt::format("{} has no surfaces: export a solid", path.string()));
    }
    mesh.diagonal = bounding_box(mesh.vertices, 0).edges().norm();
    return mesh;
}

}  // namespace controlspace
