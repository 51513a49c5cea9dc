#include "mesh/read_medit_mesh.h"

#include <string>

#include "sources/medit.h"
#include "sources/medit_words.h"
#include "sources/text_file.h"

namespace controlspace {
namespace {

/// Elements stand in any order in the file: each kind is looked for from its beginning.
template <std::size_t n>
std::vector<std::array<VertexIndex, n>> read_elements(std::string_view text,
                                                      const std::filesystem::path& path,
                                                      std::string_view keyword,
                                                      std::size_t vertices) {
    MeditWords words(text, path);
    words.find(keyword);
    std::vector<std::array<VertexIndex, n>> elements(words.rows(keyword, n + 1));
    for (std::size_t i = 0; i < elements.size(); ++i) {
        for (VertexIndex& corner : elements[i]) {
            corner = static_cast<VertexIndex>(words.index_up_to(vertices, keyword, i) - 1);
        }
        words.number(keyword, i);  // a reference, which has no meaning here
    }
    return elements;
}

}  // namespace

TetMesh read_medit_mesh(const std::filesystem::path& path) {
    const std::string text = read_text_file(path);
    TetMesh mesh;
    mesh.vertices = parse_medit_vertices(text, path);
    mesh.triangles = read_elements<3>(text, path, "Triangles", mesh.vertices.size());
    mesh.tets = read_elements<4>(text, path, "Tetrahedra", mesh.vertices.size());
    turn_upright(mesh);
    return mesh;
}

}  // namespace controlspace
