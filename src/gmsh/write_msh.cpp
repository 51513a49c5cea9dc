#include "controlspace/mesh/write_msh.h"

#include <fmt/format.h>
#include <gmsh.h>

#include <string>
#include <vector>

#include "controlspace/error.h"
#include "gmsh/gmsh_session.h"

namespace controlspace {

void write_msh(const std::filesystem::path& path, const TetMesh& mesh) {
    in_gmsh_session(1, [&] {
        constexpr int surface = 2, volume = 3;
        const auto add = [](int dimension) { return gmsh::model::addDiscreteEntity(dimension); };
        const int box = add(volume), sides = add(surface);
        std::vector<std::size_t> tags(mesh.vertices.size());
        std::vector<double> coordinates;
        for (std::size_t i = 0; i < tags.size(); ++i) {
            tags[i] = i + 1;
            coordinates.insert(coordinates.end(), mesh.vertices[i].begin(), mesh.vertices[i].end());
        }
        gmsh::model::mesh::addNodes(volume, box, tags, coordinates);
        std::size_t last_tag = 0;
        const auto add_elements = [&](int entity, int type, const auto& elements) {
            std::vector<std::size_t> element_tags, nodes;
            for (const auto& element : elements) {
                element_tags.push_back(++last_tag);
                for (const VertexIndex i : element) nodes.push_back(i + 1);
            }
            gmsh::model::mesh::addElementsByType(entity, type, element_tags, nodes);
        };
        add_elements(sides, gmsh_triangle, mesh.triangles);
        add_elements(box, gmsh_tetrahedron, mesh.tets);
        // Gmsh goes by the ending of the name.
        std::filesystem::path partial = path;
        partial += ".partial.msh";
        gmsh::option::setNumber("Mesh.Binary", 1);
        std::error_code error;
        try {
            gmsh::write(partial.string());
            std::filesystem::rename(partial, path, error);
        } catch (...) {
            std::filesystem::remove(partial, error);
            throw;
        }
        if (error)
            throw InputError(fmt::format("cannot write {}: {}", path.string(), error.message()));
    });
}

}  // namespace controlspace
