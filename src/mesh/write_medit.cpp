#include "controlspace/mesh/write_medit.h"

#include <fmt/format.h>

#include <iterator>

#include "io/text/output_file.h"

namespace controlspace {
namespace {

template <class Elements>
void append(fmt::memory_buffer& text, const char* keyword, const Elements& elements) {
    const auto out = std::back_inserter(text);
    fmt::format_to(out, "\n{}\n{}\n", keyword, elements.size());
    for (const auto& element : elements) {
        for (const VertexIndex i : element) fmt::format_to(out, "{} ", i + 1);
        fmt::format_to(out, "1\n");
    }
}

}  // namespace

void write_medit_mesh(const std::filesystem::path& path, const TetMesh& mesh) {
    fmt::memory_buffer text;
    const auto out = std::back_inserter(text);
    fmt::format_to(out, "MeshVersionFormatted 2\n\nDimension 3\n\nVertices\n{}\n",
                   mesh.vertices.size());
    for (const Point& p : mesh.vertices) {
        fmt::format_to(out, "{} {} {} 0\n", p.x(), p.y(), p.z());
    }
    append(text, "Triangles", mesh.triangles);
    append(text, "Tetrahedra", mesh.tets);
    fmt::format_to(out, "\nEnd\n");
    OutputFile file(path);
    file.write({text.data(), text.size()});
    file.commit();
}

}  // namespace controlspace
