#include <string>

#include "controlspace/mesh/mesh_files.h"
#include "files/text_file.h"
#include "io/text/medit.h"
#include "io/text/medit_file.h"

namespace controlspace {
namespace {

/// Elements stand in any order in the file: each kind is searched for from its beginning.
template <std::size_t n>
std::vector<std::array<VertexIndex, n>> read_elements(std::string_view bytes,
                                                      const std::filesystem::path& path,
                                                      const MeditKeyword& keyword,
                                                      std::size_t vertices) {
    MeditReader file(bytes, path);
    const auto most = static_cast<std::int64_t>(vertices);
    std::vector<std::array<VertexIndex, n>> elements(file.find(keyword, 0, n + 1));
    for (std::size_t i = 0; i < elements.size(); ++i) {
        for (VertexIndex& corner : elements[i]) {
            corner = static_cast<VertexIndex>(file.integer({keyword.word, i}, most) - 1);
        }
        file.skip_reference({keyword.word, i});
    }
    return elements;
}

template <std::size_t n>
constexpr std::size_t element_bytes = (n + 1) * sizeof(std::int32_t);

template <std::size_t n>
void write_elements(MeditWriter& file, const MeditKeyword& keyword,
                    const std::vector<std::array<VertexIndex, n>>& elements) {
    file.begin(keyword, elements.size(), element_bytes<n>);
    for (std::array<VertexIndex, n> element : elements) {
        for (VertexIndex& i : element) ++i;
        file.row<VertexIndex>(element, 1);
    }
}

}  // namespace

TetMesh read_medit_mesh(const std::filesystem::path& path) {
    const std::string bytes = read_binary_file(path);
    TetMesh mesh;
    mesh.vertices = parse_medit_vertices(bytes, path);
    mesh.triangles = read_elements<3>(bytes, path, medit_triangles, mesh.vertices.size());
    mesh.tets = read_elements<4>(bytes, path, medit_tetrahedra, mesh.vertices.size());
    turn_upright(mesh);
    return mesh;
}

void write_medit_mesh(const std::filesystem::path& path, const TetMesh& mesh) {
    MeditWriter file(path, mesh.vertices.size() * medit_vertex_bytes +
                               mesh.triangles.size() * element_bytes<3> +
                               mesh.tets.size() * element_bytes<4>);
    file.begin(medit_vertices, mesh.vertices.size(), medit_vertex_bytes);
    for (const Point& p : mesh.vertices) file.row<double>({p.data(), 3}, 0);
    write_elements(file, medit_triangles, mesh.triangles);
    write_elements(file, medit_tetrahedra, mesh.tets);
    file.finish();
    file.commit();
}

}  // namespace controlspace
