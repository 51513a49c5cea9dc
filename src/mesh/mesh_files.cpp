// SPDX-License-Identifier: Apache-2.0
#include "controlspace/mesh/mesh_files.h"

#include <cstdint>
#include <string>

#include "controlspace/mesh/conformity.h"
#include "controlspace/space/sample_parallel.h"
#include "files/output_file.h"
#include "files/text_file.h"
#include "io/text/medit.h"
#include "io/text/medit_file.h"
#include "io/text/vtk_xml.h"

namespace controlspace {

namespace {

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
void write_msh_elements(OutputFile& file, std::int32_t dimension, std::int32_t type,
                        const Elements& elements, std::uint64_t first_tag) {
    if (elements.empty()) return;
    begin_block(file, dimension, type, elements.size());
    for (const auto& element : elements) {
        file.write_raw(first_tag++);
        for (const VertexIndex i : element) file.write_raw(std::uint64_t{i} + 1);
    }
}

/// Mean metric length of the edges of a tetrahedron, each by the mean of the metrics at its ends.
double mean_edge_length(const TetMesh& mesh, const Tetrahedron& tet,
                        std::span<const Metric> metrics) {
    double sum = 0;
    for (const auto& [i, j] : tet_edges) {
        const VertexIndex a = tet[i], b = tet[j];
        const Vector v = mesh.vertices[b] - mesh.vertices[a];
        sum += 0.5 * (metric_length(metrics[a], v) + metric_length(metrics[b], v));
    }
    return sum / static_cast<double>(tet_edges.size());
}

}  // namespace

TetMesh read_medit_mesh(const std::filesystem::path& path) {
    const std::string bytes = read_binary_file(path);
    TetMesh mesh;
    mesh.vertices = parse_medit_vertices(bytes, path);
    mesh.triangles = read_medit_elements<3>(bytes, path, medit_triangles, mesh.vertices.size());
    mesh.tets = read_medit_elements<4>(bytes, path, medit_tetrahedra, mesh.vertices.size());
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
    write_msh_elements(file, surfaces, triangle_type, mesh.triangles, 1);
    write_msh_elements(file, volumes, tetrahedron_type, mesh.tets, 1 + mesh.triangles.size());
    file.write("\n$EndElements\n");
    file.commit();
}

void write_vtu(const std::filesystem::path& path, const TetMesh& mesh, const ControlSpace& field) {
    const std::vector<Metric> metrics = sample_parallel(field, mesh.vertices);
    VtkArray tensor{"length_tensor", 6, {}}, h_min{"h_min", 1, {}};
    for (const Metric& m : metrics) {
        tensor.values.insert(tensor.values.end(), {m.xx, m.yy, m.zz, m.xy, m.yz, m.xz});
        h_min.values.push_back(is_isotropic(m) ? m.xx : eigen_frame(m).lengths[0]);
    }
    VtkArray quality{"quality", 1, tet_qualities(mesh, metrics)}, edges{"edge_length", 1, {}};
    VtkCells cells{VtkCells::tetrahedron, 4, {}};
    for (const Tetrahedron& tet : mesh.tets) {
        edges.values.push_back(mean_edge_length(mesh, tet, metrics));
        cells.points.insert(cells.points.end(), tet.begin(), tet.end());
    }
    write_vtk_grid(path, mesh.vertices, cells, std::array{tensor, h_min},
                   std::array{quality, edges});
}

}  // namespace controlspace
