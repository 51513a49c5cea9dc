#include "controlspace/mesh/write_vtu.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "controlspace/mesh/conformity.h"
#include "io/text/output_file.h"

namespace controlspace {
namespace {

/// The data of the file: each array is preceded by its number of bytes, and found by its offset.
class AppendedData {
public:
    /// The DataArray element for `values`, which it adds.
    template <class Value>
    std::string add(std::string_view name, std::string_view type, int components,
                    const std::vector<Value>& values) {
        std::string element = fmt::format(
            "<DataArray type=\"{}\" Name=\"{}\" NumberOfComponents=\"{}\" "
            "format=\"appended\" offset=\"{}\"/>\n",
            type, name, components, bytes_.size());
        const std::uint64_t size = values.size() * sizeof(Value);
        append(&size, sizeof size);
        append(values.data(), size);
        return element;
    }
    const std::string& bytes() const { return bytes_; }

private:
    void append(const void* data, std::size_t size) {
        bytes_.append(static_cast<const char*>(data), size);
    }
    std::string bytes_;
};

struct PointData {
    std::vector<double> length_tensor;
    std::vector<double> h_min;
};

PointData point_data(std::span<const Metric> metrics) {
    PointData data;
    for (const Metric& m : metrics) {
        data.length_tensor.insert(data.length_tensor.end(), {m.xx, m.yy, m.zz, m.xy, m.yz, m.xz});
        data.h_min.push_back(is_isotropic(m) ? m.xx : eigen_frame(m).lengths[0]);
    }
    return data;
}

/// Mean metric length of each tetrahedron's edges, each by the mean of the metrics at its ends.
std::vector<double> mean_edge_lengths(const TetMesh& mesh, std::span<const Metric> metrics) {
    std::vector<double> means;
    means.reserve(mesh.tets.size());
    for (const Tetrahedron& tet : mesh.tets) {
        double sum = 0;
        for (const auto& [i, j] : tet_edges) {
            const VertexIndex a = tet[i], b = tet[j];
            const Vector v = mesh.vertices[b] - mesh.vertices[a];
            sum += 0.5 * (metric_length(metrics[a], v) + metric_length(metrics[b], v));
        }
        means.push_back(sum / static_cast<double>(tet_edges.size()));
    }
    return means;
}

std::vector<double> coordinates_of(const TetMesh& mesh) {
    std::vector<double> coordinates;
    for (const Point& p : mesh.vertices) coordinates.insert(coordinates.end(), p.begin(), p.end());
    return coordinates;
}

struct Cells {
    std::vector<std::int64_t> connectivity, offsets;
    std::vector<std::uint8_t> types;
};

Cells cells_of(const TetMesh& mesh) {
    constexpr std::uint8_t vtk_tetra = 10;
    Cells cells;
    for (const Tetrahedron& tet : mesh.tets) {
        cells.connectivity.insert(cells.connectivity.end(), tet.begin(), tet.end());
        cells.offsets.push_back(static_cast<std::int64_t>(cells.connectivity.size()));
        cells.types.push_back(vtk_tetra);
    }
    return cells;
}

}  // namespace

void write_vtu(const std::filesystem::path& path, const TetMesh& mesh, const MetricField& field) {
    static_assert(std::endian::native == std::endian::little, "the file says so");
    std::vector<Metric> metrics(mesh.vertices.size());
    field.evaluate(mesh.vertices, metrics);
    const PointData points = point_data(metrics);
    const Cells cells = cells_of(mesh);

    AppendedData data;
    std::string head = fmt::format(
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" "
        "byte_order=\"LittleEndian\" header_type=\"UInt64\">\n<UnstructuredGrid>\n"
        "<Piece NumberOfPoints=\"{}\" NumberOfCells=\"{}\">\n<PointData>\n",
        mesh.vertices.size(), mesh.tets.size());
    head += data.add("length_tensor", "Float64", 6, points.length_tensor);
    head += data.add("h_min", "Float64", 1, points.h_min);
    head += "</PointData>\n<CellData>\n";
    head += data.add("quality", "Float64", 1, tet_qualities(mesh, metrics));
    head += data.add("edge_length", "Float64", 1, mean_edge_lengths(mesh, metrics));
    head += "</CellData>\n<Points>\n";
    head += data.add("Points", "Float64", 3, coordinates_of(mesh));
    head += "</Points>\n<Cells>\n";
    head += data.add("connectivity", "Int64", 1, cells.connectivity);
    head += data.add("offsets", "Int64", 1, cells.offsets);
    head += data.add("types", "UInt8", 1, cells.types);
    head += "</Cells>\n</Piece>\n</UnstructuredGrid>\n<AppendedData encoding=\"raw\">\n_";

    OutputFile file(path);
    file.write(head);
    file.write(data.bytes());
    file.write("\n</AppendedData>\n</VTKFile>\n");
    file.commit();
}

}  // namespace controlspace
