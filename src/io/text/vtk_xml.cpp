// SPDX-License-Identifier: Apache-2.0
#include "io/text/vtk_xml.h"

#include <fmt/format.h>

#include <bit>
#include <string_view>

#include "controlspace/io/read_sources.h"
#include "files/output_file.h"
#include "io/text/metric_rows.h"

namespace controlspace {
namespace {

static_assert(std::endian::native == std::endian::little, "the files say so");

std::string head_of(std::string_view type) {
    return fmt::format(
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"{}\" version=\"1.0\" "
        "byte_order=\"LittleEndian\" header_type=\"UInt64\">\n",
        type);
}

/// A file under construction: the XML, and the arrays that are appended to it.
class Xml {
public:
    explicit Xml(std::string_view type) : type_(type), text_(head_of(type)) {}

    void add(std::string_view text) { text_ += text; }

    /// `values` must outlive this. The number of tuples is written unless it is 0.
    template <class Value>
    void add_array(std::string_view name, std::string_view type, int components,
                   const std::vector<Value>& values, std::size_t tuples = 0) {
        text_ += fmt::format(
            "<DataArray type=\"{}\" Name=\"{}\" NumberOfComponents=\"{}\" format=\"appended\" "
            "offset=\"{}\"{}/>\n",
            type, name, components, offset_,
            tuples == 0 ? "" : fmt::format(" NumberOfTuples=\"{}\"", tuples));
        const std::string_view bytes(reinterpret_cast<const char*>(values.data()),
                                     values.size() * sizeof(Value));
        arrays_.push_back(bytes);
        offset_ += sizeof(std::uint64_t) + bytes.size();
    }
    void add_arrays(std::string_view element, std::span<const VtkArray> arrays,
                    std::size_t tuples = 0) {
        text_ += fmt::format("<{}>\n", element);
        for (const VtkArray& a : arrays)
            add_array(a.name, "Float64", a.components, a.values, tuples);
        text_ += fmt::format("</{}>\n", element);
    }

    std::string head() const {
        return fmt::format("{}</{}>\n<AppendedData encoding=\"raw\">\n_", text_, type_);
    }
    static constexpr std::string_view tail = "\n</AppendedData>\n</VTKFile>\n";

    void write(const std::filesystem::path& path) const {
        OutputFile file(path);
        file.write(head());
        for (const std::string_view bytes : arrays_) {
            file.write_raw(std::uint64_t{bytes.size()});
            file.write(bytes);
        }
        file.write(tail);
        file.commit();
    }

private:
    std::string_view type_;
    std::string text_;
    std::vector<std::string_view> arrays_;
    std::uint64_t offset_ = 0;
};

/// The beginning of an image.
Xml image(const Point& origin, const Vector& spacing, const std::array<int, 3>& counts) {
    const std::string extent =
        fmt::format("0 {} 0 {} 0 {}", counts[0] - 1, counts[1] - 1, counts[2] - 1);
    Xml xml("ImageData");
    xml.add(fmt::format(
        "<ImageData WholeExtent=\"{}\" Origin=\"{} {} {}\" Spacing=\"{} {} {}\">\n"
        "<Piece Extent=\"{}\">\n",
        extent, origin.x(), origin.y(), origin.z(), spacing.x(), spacing.y(), spacing.z(), extent));
    return xml;
}

}  // namespace

std::vector<VtkArray> metric_arrays(std::span<const Metric> metrics) {
    std::vector<VtkArray> arrays{{vtk_metric_array, 9, {}},
                                 {"h_min", 1, {}},
                                 {"h_max", 1, {}},
                                 {"h_mean", 1, {}},
                                 {"anisotropy", 1, {}}};
    for (VtkArray& array : arrays) {
        array.values.reserve(metrics.size() * static_cast<std::size_t>(array.components));
    }
    for (const Metric& m : metrics) {
        const auto rows = numbers_of(m, matrix_rows);
        arrays[0].values.insert(arrays[0].values.end(), rows.begin(), rows.end());
        const auto lengths = eigen_frame(m).lengths;
        arrays[1].values.push_back(lengths[0]);
        arrays[2].values.push_back(lengths[2]);
        arrays[3].values.push_back(mean_length(m));
        arrays[4].values.push_back(lengths[2] / lengths[0]);
    }
    return arrays;
}

void write_vtk_grid(const std::filesystem::path& path, std::span<const Point> points,
                    const VtkCells& cells, std::span<const VtkArray> point_data,
                    std::span<const VtkArray> cell_data) {
    VtkArray coordinates{"Points", 3, {}};
    for (const Point& p : points) {
        coordinates.values.insert(coordinates.values.end(), p.begin(), p.end());
    }
    const std::size_t count = cells.points.size() / cells.corners;
    std::vector<std::int64_t> ends(count);
    for (std::size_t i = 0; i < count; ++i) {
        ends[i] = static_cast<std::int64_t>((i + 1) * cells.corners);
    }
    const std::vector<std::uint8_t> types(count, cells.type);

    const bool poly = lower_case_extension(path) == ".vtp";
    const std::string_view type = poly ? "PolyData" : "UnstructuredGrid";
    Xml xml(type);
    xml.add(fmt::format("<{}>\n<Piece NumberOfPoints=\"{}\" ", type, points.size()));
    xml.add(poly ? fmt::format("NumberOfVerts=\"{}\" NumberOfLines=\"0\" NumberOfStrips=\"0\" "
                               "NumberOfPolys=\"0\">\n",
                               count)
                 : fmt::format("NumberOfCells=\"{}\">\n", count));
    xml.add_arrays("PointData", point_data);
    xml.add_arrays("CellData", cell_data);
    xml.add_arrays("Points", {&coordinates, 1});
    xml.add(poly ? "<Verts>\n" : "<Cells>\n");
    xml.add_array("connectivity", "Int64", 1, cells.points);
    xml.add_array("offsets", "Int64", 1, ends);
    if (!poly) xml.add_array("types", "UInt8", 1, types);
    xml.add(poly ? "</Verts>\n</Piece>\n" : "</Cells>\n</Piece>\n");
    xml.write(path);
}

void write_vtk_pieces(const std::filesystem::path& path,
                      std::span<const std::filesystem::path> pieces,
                      std::span<const VtkArray> cell_data) {
    OutputFile file(path);
    const auto print_array = [&](std::string_view name, int components) {
        file.print("<PDataArray type=\"Float64\" Name=\"{}\" NumberOfComponents=\"{}\"/>\n", name,
                   components);
    };
    file.write(head_of("PUnstructuredGrid"));
    file.write("<PUnstructuredGrid GhostLevel=\"0\">\n<PCellData>\n");
    for (const VtkArray& array : cell_data) print_array(array.name, array.components);
    file.write("</PCellData>\n<PPoints>\n");
    print_array("Points", 3);
    file.write("</PPoints>\n");
    for (const auto& piece : pieces) {
        file.print("<Piece Source=\"{}\"/>\n", piece.filename().string());
    }
    file.write("</PUnstructuredGrid>\n</VTKFile>\n");
    file.commit();
}

void write_vtk_image(const std::filesystem::path& path, const Point& origin, const Vector& spacing,
                     const std::array<int, 3>& counts, std::span<const VtkArray> point_data) {
    Xml xml = image(origin, spacing, counts);
    xml.add_arrays("PointData", point_data);
    xml.add("</Piece>\n");
    xml.write(path);
}

std::pair<std::string, std::string> vtk_image_frame(const Point& origin, const Vector& spacing,
                                                    const std::array<int, 3>& counts,
                                                    std::string_view array, std::uint64_t bytes) {
    Xml xml = image(origin, spacing, counts);
    xml.add("<PointData>\n");
    xml.add_array(array, "Float64", 1, std::vector<double>());
    xml.add("</PointData>\n</Piece>\n");
    std::string head = xml.head();
    head.append(reinterpret_cast<const char*>(&bytes), sizeof bytes);
    return {std::move(head), std::string(Xml::tail)};
}

void write_vtk_octrees(const std::filesystem::path& path, const Box& domain,
                       const std::array<int, 3>& counts, std::span<const VtkTree> trees) {
    Xml xml("HyperTreeGrid");
    std::array<std::vector<double>, 3> planes;  // those of the grid, one where it is flat
    for (std::size_t a = 0; a < 3; ++a) {
        const auto axis = static_cast<Axis>(a);
        planes[a].push_back(domain.low[axis]);
        for (int i = 1; i <= counts[a] && domain.low[axis] < domain.high[axis]; ++i) {
            const double share = static_cast<double>(i) / counts[a];
            planes[a].push_back(std::lerp(domain.low[axis], domain.high[axis], share));
        }
    }
    xml.add(fmt::format(
        "<HyperTreeGrid BranchFactor=\"2\" TransposedRootIndexing=\"0\" Dimensions=\"{} {} {}\">\n"
        "<Grid>\n",
        planes[0].size(), planes[1].size(), planes[2].size()));
    for (std::size_t a = 0; a < 3; ++a) {
        xml.add_array(fmt::format("{}Coordinates", "XYZ"[a]), "Float64", 1, planes[a],
                      planes[a].size());
    }
    xml.add("</Grid>\n<Trees>\n");
    // What the file refers to has to stay until it is written.
    std::vector<std::vector<std::uint8_t>> descriptors;
    descriptors.reserve(trees.size());
    for (std::size_t i = 0; i < trees.size(); ++i) {
        const auto& [is_split, level_counts, cell_data] = trees[i];
        // Bits, the first of a byte in its highest place; the last level has no children.
        const std::size_t bits = is_split.size() - static_cast<std::size_t>(level_counts.back());
        std::vector<std::uint8_t>& descriptor = descriptors.emplace_back((bits + 7) / 8);
        for (std::size_t k = 0; k < bits; ++k) {
            if (is_split[k]) descriptor[k / 8] |= static_cast<std::uint8_t>(0x80 >> k % 8);
        }
        xml.add(fmt::format("<Tree Index=\"{}\" NumberOfLevels=\"{}\" NumberOfVertices=\"{}\">\n",
                            i, level_counts.size(), is_split.size()));
        xml.add_array("Descriptor", "Bit", 1, descriptor, bits);
        xml.add_array("NbVerticesByLevel", "Int64", 1, level_counts, level_counts.size());
        xml.add_arrays("CellData", cell_data, is_split.size());
        xml.add("</Tree>\n");
    }
    xml.add("</Trees>\n");
    xml.write(path);
}

}  // namespace controlspace
