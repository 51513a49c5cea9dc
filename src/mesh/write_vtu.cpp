#include "controlspace/mesh/conformity.h"
#include "controlspace/mesh/mesh_files.h"
#include "controlspace/space/sample_parallel.h"
#include "io/text/vtk_xml.h"

namespace controlspace {
namespace {

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

void write_vtu(const std::filesystem::path& path, const TetMesh& mesh, const ControlSpace& field) {
    std::vector<Metric> metrics(mesh.vertices.size());
    sample_parallel(field, mesh.vertices, metrics);
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
