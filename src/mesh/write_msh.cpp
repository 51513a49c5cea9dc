#include <cstdint>

#include "controlspace/mesh/mesh_files.h"
#include "files/output_file.h"

namespace controlspace {
namespace {

constexpr std::int32_t surfaces = 2, volumes = 3, entity = 1;  // dimensions, and a tag
constexpr std::int32_t triangle_type = 2, tetrahedron_type = 4;

/// The head of a block of nodes or elements.
void begin_block(OutputFile& file, std::int32_t dimension, std::int32_t kind, std::size_t count) {
    file.write_raw(dimension);
    file.write_raw(entity);
    file.write_raw(kind);
    file.write_raw(std::uint64_t{count});
}

/// Counts, and the smallest and the largest number.
void begin_section(OutputFile& file, const char* name, std::size_t blocks, std::size_t count) {
    file.print("${}\n", name);
    const std::uint64_t head[] = {blocks, count, 1, count};
    file.write_raw(head, std::size(head));
}

template <class Elements>
void write_elements(OutputFile& file, std::int32_t dimension, std::int32_t type,
                    const Elements& elements, std::uint64_t first_tag) {
    if (elements.empty()) return;
    begin_block(file, dimension, type, elements.size());
    for (const auto& element : elements) {
        file.write_raw(first_tag++);
        for (const VertexIndex i : element) file.write_raw(std::uint64_t{i} + 1);
    }
}

}  // namespace

void write_msh(const std::filesystem::path& path, const TetMesh& mesh) {
    OutputFile file(path);
    file.write("$MeshFormat\n4.1 1 8\n");
    file.write_raw(std::int32_t{1});  // shows the byte order
    file.write("\n$EndMeshFormat\n$Entities\n");
    const std::uint64_t entities[] = {0, 0, 1, 1};  // points, curves, surfaces, volumes
    file.write_raw(entities, std::size(entities));
    const Box extent = bounding_box(mesh.vertices, 0);
    for (int i = 0; i < 2; ++i) {
        file.write_raw(entity);
        file.write_raw(extent.low.data(), 3);
        file.write_raw(extent.high.data(), 3);
        const std::uint64_t groups_and_boundaries[] = {0, 0};
        file.write_raw(groups_and_boundaries, 2);
    }
    file.write("\n$EndEntities\n");

    begin_section(file, "Nodes", 2, mesh.vertices.size());
    constexpr std::int32_t not_parametric = 0;
    begin_block(file, surfaces, not_parametric, 0);
    begin_block(file, volumes, not_parametric, mesh.vertices.size());
    for (std::uint64_t tag = 1; tag <= mesh.vertices.size(); ++tag) file.write_raw(tag);
    for (const Point& p : mesh.vertices) file.write_raw(p.data(), 3);
    file.write("\n$EndNodes\n");

    const std::size_t blocks = (mesh.triangles.empty() ? 0 : 1) + (mesh.tets.empty() ? 0 : 1);
    begin_section(file, "Elements", blocks, mesh.triangles.size() + mesh.tets.size());
    write_elements(file, surfaces, triangle_type, mesh.triangles, 1);
    write_elements(file, volumes, tetrahedron_type, mesh.tets, 1 + mesh.triangles.size());
    file.write("\n$EndElements\n");
    file.commit();
}

}  // namespace controlspace
