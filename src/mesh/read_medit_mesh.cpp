#include "mesh/read_medit_mesh.h"

#include <string>

#include "io/text/medit.h"

namespace controlspace {
namespace {

/// Elements stand in any order in the file: each kind is looked for from its beginning.
template <std::size_t n>
std::vector<std::array<VertexIndex, n>> read_elements(std::string_view bytes,
                                                      const std::filesystem::path& path,
                                                      std::string_view keyword,
                                                      std::size_t vertices) {
    return read_medit(bytes, path, [&](auto& file) {
        file.find(keyword);
        std::vector<std::array<VertexIndex, n>> elements(file.rows(keyword, 0, n + 1));
        for (std::size_t i = 0; i < elements.size(); ++i) {
            for (VertexIndex& corner : elements[i]) {
                corner = static_cast<VertexIndex>(file.index_up_to(vertices, keyword, i) - 1);
            }
            file.skip_reference(keyword, i);
        }
        return elements;
    });
}

}  // namespace

TetMesh read_medit_mesh(const std::filesystem::path& path) {
    const std::string bytes = read_binary_file(path);
    TetMesh mesh;
    mesh.vertices = parse_medit_vertices(bytes, path);
    mesh.triangles = read_elements<3>(bytes, path, "Triangles", mesh.vertices.size());
    mesh.tets = read_elements<4>(bytes, path, "Tetrahedra", mesh.vertices.size());
    turn_upright(mesh);
    return mesh;
}

}  // namespace controlspace
