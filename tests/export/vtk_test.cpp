// SPDX-License-Identifier: Apache-2.0
// Files of VTK, read by VTK itself and by our reader.
#include <fmt/format.h>
#include <vtkCell.h>
#include <vtkCellData.h>
#include <vtkCellTypeSource.h>
#include <vtkDoubleArray.h>
#include <vtkFloatArray.h>
#include <vtkHyperTreeGrid.h>
#include <vtkHyperTreeGridNonOrientedGeometryCursor.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkProbeFilter.h>
#include <vtkUnsignedCharArray.h>
#include <vtkUnstructuredGrid.h>
#include <vtkXMLHyperTreeGridReader.h>
#include <vtkXMLImageDataReader.h>
#include <vtkXMLImageDataWriter.h>
#include <vtkXMLPUnstructuredGridReader.h>
#include <vtkXMLPolyDataWriter.h>
#include <vtkXMLUnstructuredGridReader.h>
#include <vtkXMLUnstructuredGridWriter.h>

#include <Eigen/Geometry>
#include <array>
#include <catch2/catch.hpp>
#include <numeric>
#include <random>

#include "controlspace/fields/formula_field.h"
#include "controlspace/geometry/extent.h"
#include "controlspace/io/read_vtk_sources.h"
#include "controlspace/io/write_vtk.h"
#include "controlspace/sources/riemannian.h"
#include "controlspace/sources/sampled_surfaces.h"
#include "controlspace/space/catalogue.h"
#include "editable_space.h"
#include "files/text_file.h"
#include "io/text/cells.h"
#include "io/text/metric_rows.h"
#include "io/text/vtk_xml.h"
#include "sources/files.h"

namespace controlspace::vtk_test {

using Catch::Matchers::Contains;

namespace {

const Box domain{{-1, -1, -1}, {1, 1, 2}};

/// Filled with tensors whose numbers all differ; of sources outside, the nearest places in the box.
std::unique_ptr<EditableSpace> filled(const std::string& id, const Box& box = domain) {
    std::vector<PointSource> sources = sample_sphere({.h = 0.2, .rho = 2});
    for (PointSource& s : sources) {
        s.position = s.position.cwiseMax(box.low).cwiseMin(box.high);
        const Point& p = s.position;
        s.metric = {0.3 + 0.1 * p.x(), 0.4 + 0.1 * p.y(), 0.5, 0.02 + 0.01 * p.x(), -0.03, 0.05};
    }
    auto space = editable(tree_named(id).make({.domain = box, .finest_length = 0.15}));
    space->insert(sources);
    return space;
}

template <class Reader>
auto read_back(const std::filesystem::path& path) {
    vtkNew<Reader> reader;
    reader->SetFileName(path.c_str());
    reader->Update();
    return vtkSmartPointer(reader->GetOutput());
}

Eigen::Matrix3d tensor_at(vtkDataSetAttributes& data, vtkIdType i) {
    std::array<double, 9> t{};
    data.GetArray(vtk_metric_array)->GetTuple(i, t.data());
    return Eigen::Map<Eigen::Matrix3d>(t.data());
}

bool is_riemannian_of(const Eigen::Matrix3d& t, const Metric& m) {
    return (m.matrix() * t * m.matrix()).isApprox(Eigen::Matrix3d::Identity(), 1e-10);
}

double value_at(vtkDataSetAttributes& data, const char* name, vtkIdType i) {
    return data.GetArray(name)->GetTuple1(i);
}

Metric metric_at(const ControlSpace& field, const Point& p) {
    Metric m;
    field.sample({&p, 1}, {&m, 1});
    return m;
}

void check_close(const std::vector<PointSource>& a, const std::vector<PointSource>& b,
                 double tolerance = 1e-12) {
    REQUIRE(a.size() == b.size());
    for (std::size_t i = 0; i < a.size(); ++i) {
        CHECK((a[i].position - b[i].position).norm() <= tolerance);
        CHECK(a[i].metric.matrix().isApprox(b[i].metric.matrix(), tolerance));
    }
}

/// Writes a file by VTK's own writer, with lengths `h` at the points.
template <class Writer>
void write_grid(const std::filesystem::path& path, vtkDataSet& grid,
                const std::function<double(const Point&)>& length_at) {
    vtkNew<vtkDoubleArray> sizes;
    sizes->SetName("h");
    for (vtkIdType i = 0; i < grid.GetNumberOfPoints(); ++i) {
        sizes->InsertNextValue(length_at(Point(grid.GetPoint(i))));
    }
    grid.GetPointData()->AddArray(sizes);
    vtkNew<Writer> writer;
    writer->SetFileName(path.c_str());
    writer->SetInputData(&grid);
    writer->Write();
}

const std::vector<PointSource> two{{{0.1, -0.2, 0.3}, {0.3, 0.4, 0.5, 0.02, -0.03, 0.05}},
                                   {{1, 2, 4}, {0.35, 0.45, 0.55, -0.01, 0.06, 0.07}}};

/// `two` in a .vtp by VTK's own writer.
template <class Array>
std::filesystem::path write_vtp(const ScratchDirectory& folder, int components, const char* name,
                                vtkXMLWriter& writer) {
    vtkNew<vtkPolyData> grid;
    vtkNew<vtkPoints> points;
    vtkNew<Array> array;
    array->SetName(name);
    array->SetNumberOfComponents(components);
    for (const PointSource& s : two) {
        points->InsertNextPoint(s.position.data());
        const Metric t = to_riemannian(s.metric);
        const double h[] = {s.metric.xx};
        const double vtk_order[] = {t.xx, t.yy, t.zz, t.xy, t.yz, t.xz};
        const double rows[] = {t.xx, t.xy, t.xz, t.xy, t.yy, t.yz, t.xz, t.yz, t.zz};
        array->InsertNextTuple(components == 1 ? h : components == 6 ? vtk_order : rows);
    }
    grid->SetPoints(points);
    grid->GetPointData()->AddArray(array);
    const auto path = folder.path() / "two.vtp";
    writer.SetInputDataObject(grid);
    writer.SetFileName(path.c_str());
    writer.Write();
    return path;
}

}  // namespace

TEST_CASE("leaves are hexahedra with the metrics at their centres") {
    const std::string id = GENERATE("K_oL", "K_V");
    const ScratchDirectory folder;
    const auto space = filled(id);
    write_leaves(folder.path() / "leaves.vtu", *space);
    const auto grid = read_back<vtkXMLUnstructuredGridReader>(folder.path() / "leaves.vtu");
    const std::vector<Box> elements = elements_of(*space);
    REQUIRE(static_cast<std::size_t>(grid->GetNumberOfCells()) == elements.size());
    for (vtkIdType i = 0; i < grid->GetNumberOfCells(); ++i) {
        const Box& box = elements[static_cast<std::size_t>(i)];
        vtkCell& cell = *grid->GetCell(i);
        REQUIRE(cell.GetCellType() == VTK_HEXAHEDRON);
        std::array<Point, 8> p;
        for (int k = 0; k < 8; ++k) cell.GetPoints()->GetPoint(k, p[std::size_t(k)].data());
        CHECK(p[0] == box.low);
        CHECK(p[6] == box.high);
        CHECK((p[1] - p[0]).cross(p[3] - p[0]).dot(p[4] - p[0]) == Approx(box.edges().prod()));
        const Metric m = sample_at(*space, box.centre());
        CHECK(is_riemannian_of(tensor_at(*grid->GetCellData(), i), m));
        const auto lengths = eigen_frame(m).lengths;
        CHECK(value_at(*grid->GetCellData(), "h_min", i) == Approx(lengths[0]));
        CHECK(value_at(*grid->GetCellData(), "h_max", i) == Approx(lengths[2]));
        CHECK(value_at(*grid->GetCellData(), "h_mean", i) == Approx(mean_length(m)));
        CHECK(value_at(*grid->GetCellData(), "anisotropy", i) == Approx(lengths[2] / lengths[0]));
    }
}

TEST_CASE("leaves in pieces are one grid") {
    const ScratchDirectory folder;
    const auto space = filled("K_oL");
    const auto half = [&](bool high) {
        Box box = domain;
        (high ? box.low : box.high)[1] = domain.centre()[1];
        return std::vector{box};
    };
    const std::vector<std::filesystem::path> pieces{folder / "all_0.vtu", folder / "all_1.vtu"};
    write_leaves(pieces[0], *space, half(false));
    write_leaves(pieces[1], *space, half(true));
    write_leaf_pieces(folder / "all.pvtu", pieces);
    const auto grid = read_back<vtkXMLPUnstructuredGridReader>(folder / "all.pvtu");
    const std::vector<Box> elements = elements_of(*space);
    REQUIRE(static_cast<std::size_t>(grid->GetNumberOfCells()) == elements.size());
    double volume = 0;
    for (vtkIdType i = 0; i < grid->GetNumberOfCells(); ++i) {
        std::array<double, 6> b;
        grid->GetCell(i)->GetBounds(b.data());
        const Box box{{b[0], b[2], b[4]}, {b[1], b[3], b[5]}};
        volume += measure(box);
        const Metric m = sample_at(*space, box.centre());
        CHECK(is_riemannian_of(tensor_at(*grid->GetCellData(), i), m));
    }
    CHECK(volume == Approx(measure(domain)));
}

TEST_CASE("control nodes are points that can be read as sources") {
    const ScratchDirectory folder;
    const auto space = filled("K_oV");
    write_nodes(folder.path() / "nodes.vtu", *space);
    const ControlNodes nodes = space->control_nodes(Neighbourhood::faces);
    const std::vector<Point> places = positions(nodes.graph);
    std::vector<PointSource> expected;
    for (std::size_t i = 0; i < places.size(); ++i)
        expected.push_back({places[i], nodes.metrics[i]});
    check_close(read_vtk_sources(folder.path() / "nodes.vtu"), expected);
}

TEST_CASE("an octree is a hyper tree grid with the same leaves") {
    const ScratchDirectory folder;
    // Of the oblong one, trees for each of which all axes are cut; the others are flat.
    const Box box =
        GENERATE(Box(domain), Box{Point(-1, -1, -1), Point(9, 1, 1.5)},
                 Box{Point(-1, -1, 0), Point(1, 1.5, 0)}, Box{Point(0, -1, -1), Point(0, 1, 1)},
                 Box{Point(-1, 0.5, -1), Point(8, 0.5, 1)});
    CAPTURE(to_string(box));
    const auto space = filled("K_oL", box);
    write_octree(folder.path() / "tree.htg", *space);
    vtkNew<vtkXMLHyperTreeGridReader> reader;
    reader->SetFileName((folder.path() / "tree.htg").c_str());
    reader->Update();
    auto& grid = *vtkHyperTreeGrid::SafeDownCast(reader->GetOutputDataObject(0));
    REQUIRE(static_cast<std::size_t>(grid.GetNumberOfLeaves()) >= space->footprint().cells);
    if (grid.GetMaxNumberOfTrees() == 1) {
        REQUIRE(static_cast<std::size_t>(grid.GetNumberOfLeaves()) == space->footprint().cells);
    }
    vtkNew<vtkHyperTreeGridNonOrientedGeometryCursor> cursor;
    int leaves = 0;
    double area = 0;
    const std::function<void()> visit = [&] {
        if (!cursor->IsLeaf()) {
            for (unsigned char c = 0; c < cursor->GetNumberOfChildren(); ++c) {
                cursor->ToChild(c);
                visit();
                cursor->ToParent();
            }
            return;
        }
        ++leaves;
        Point centre;
        cursor->GetPoint(centre.data());
        std::array<double, 6> sides;
        cursor->GetBounds(sides.data());
        const Box leaf{Point(sides[0], sides[2], sides[4]), Point(sides[1], sides[3], sides[5])};
        area += measure(leaf);
        const Box cell = space->cell_at(centre).value();
        // Trees begin with cells near cubes; a leaf above these is in several.
        if (cursor->GetLevel() > 0) REQUIRE(cell.centre().isApprox(centre, 1e-12));
        REQUIRE((cell.low - leaf.low).maxCoeff() < 1e-12);
        REQUIRE((leaf.high - cell.high).maxCoeff() < 1e-12);
        REQUIRE(is_riemannian_of(tensor_at(*grid.GetCellData(), cursor->GetGlobalNodeIndex()),
                                 sample_at(*space, centre)));
    };
    for (vtkIdType tree = 0; tree < grid.GetMaxNumberOfTrees(); ++tree) {
        grid.InitializeNonOrientedGeometryCursor(cursor, tree);
        visit();
    }
    CHECK(leaves == grid.GetNumberOfLeaves());
    CHECK(area == Approx(measure(box)));
    CHECK_THAT(error_of([&] { write_octree(folder.path() / "kd.htg", *filled("K_L")); }),
               Contains("only an octree"));
    CHECK_FALSE(std::filesystem::exists(folder.path() / "kd.htg"));
}

TEST_CASE("on a plane, leaves are quadrilaterals, and an image is of the plane") {
    const ScratchDirectory folder;
    for (Axis a = 0; a < 3; ++a) {
        Box box = domain;
        box.low[a] = box.high[a] = 0.25;
        const auto space = filled("K_V", box);
        write_leaves(folder.path() / "flat.vtu", *space);
        const auto grid = read_back<vtkXMLUnstructuredGridReader>(folder.path() / "flat.vtu");
        REQUIRE(static_cast<std::size_t>(grid->GetNumberOfCells()) == space->footprint().cells);
        double area = 0;
        for (vtkIdType i = 0; i < grid->GetNumberOfCells(); ++i) {
            vtkCell& cell = *grid->GetCell(i);
            REQUIRE(cell.GetCellType() == VTK_QUAD);
            std::array<Point, 4> p;
            for (int k = 0; k < 4; ++k) cell.GetPoints()->GetPoint(k, p[std::size_t(k)].data());
            CHECK(p[0] + p[2] == p[1] + p[3]);
            area += (p[1] - p[0]).cross(p[3] - p[0]).norm();
        }
        CHECK(area == Approx(measure(box)));
        write_slice(folder.path() / "flat.vti", *space, box, {.axis = a, .at = 0.25, .samples = 9});
        const auto image = read_back<vtkXMLImageDataReader>(folder.path() / "flat.vti");
        CHECK(image->GetNumberOfPoints() >= 9 * 6);
        for (vtkIdType i = 0; i < image->GetNumberOfPoints(); ++i) {
            Point x;
            image->GetPoint(i, x.data());
            REQUIRE(is_riemannian_of(tensor_at(*image->GetPointData(), i), sample_at(*space, x)));
        }
        // Across another axis a slice of a plane is a line.
        const Axis other = (a + 1) % 3;
        write_slice(folder.path() / "line.vti", *space, box,
                    {.axis = other, .at = box.centre()[other], .samples = 9});
        CHECK(read_back<vtkXMLImageDataReader>(folder.path() / "line.vti")->GetNumberOfPoints() ==
              9);
    }
}

TEST_CASE("a slice is an image of the field") {
    const ScratchDirectory folder;
    const FormulaField field([](const Point& p) {
        return Metric{
            0.3 + 0.05 * p.x(), 0.4 + 0.05 * p.y(), 0.5 + 0.05 * p.z(), 0.02, -0.03, 0.05};
    });
    const Axis axis = GENERATE(0, 1, 2);
    CAPTURE(axis);
    write_slice(folder.path() / "s.vti", field, domain, {.axis = axis, .at = 0.25, .samples = 13});
    const auto image = read_back<vtkXMLImageDataReader>(folder.path() / "s.vti");
    CHECK(image->GetNumberOfPoints() == (axis == 2 ? 13 * 13 : 13 * 9));
    Point low = Point::Zero(), high = low;
    for (vtkIdType i = 0; i < image->GetNumberOfPoints(); ++i) {
        Point x;
        image->GetPoint(i, x.data());
        CHECK(x[axis] == 0.25);
        if (i == 0) low = x;
        high = x;
        REQUIRE(is_riemannian_of(tensor_at(*image->GetPointData(), i), sample_at(field, x)));
    }
    Box plane = domain;
    plane.low[axis] = plane.high[axis] = 0.25;
    CHECK(low == plane.low);
    CHECK(high.isApprox(plane.high));
    const auto error = [&](const Slice& slice) {
        return error_of([&] { write_slice(folder.path() / "e.vti", field, domain, slice); });
    };
    CHECK_THAT(error({.axis = 0, .at = 1.5}), Contains("a slice at x = 1.5 is outside"));
    CHECK_THAT(error({.samples = 1}), Contains("1 samples"));
    CHECK_FALSE(std::filesystem::exists(folder.path() / "e.vti"));
}

TEST_CASE("sources that are written for VTK are read back") {
    const ScratchDirectory folder;
    for (const char* name : {"s.vtu", "s.vtp"}) {
        write_vtk_sources(folder.path() / name, two);
        check_close(read_vtk_sources(folder.path() / name), two);
    }
    CHECK_THAT(error_of([&] { write_vtk_sources("/dev/full", two); }), Contains("/dev/full"));
}

TEST_CASE("arrays of 1, 6 and 9 components, however VTK encodes them") {
    const ScratchDirectory folder;
    const int components = GENERATE(1, 6, 9);
    const auto set_mode =
        GENERATE(&vtkXMLWriter::SetDataModeToAscii, &vtkXMLWriter::SetDataModeToBinary,
                 &vtkXMLWriter::SetDataModeToAppended);
    const bool big_endian = GENERATE(false, true);
    vtkNew<vtkXMLPolyDataWriter> writer;
    (writer->*set_mode)();
    if (big_endian) writer->SetByteOrderToBigEndian();
    std::vector<PointSource> expected = two;
    if (components == 1) {
        for (PointSource& s : expected) s.metric = Metric::isotropic(s.metric.xx);
    }
    // VTK's points are of floats unless one asks for more, and its texts of a few digits.
    const double tolerance = 1e-6;
    const auto path = write_vtp<vtkDoubleArray>(folder, components, "a:metric", *writer);
    check_close(read_vtk_sources(path), expected, tolerance);
    check_close(read_vtk_sources(path, {.array = "a:metric"}), expected, tolerance);
    const auto floats = write_vtp<vtkFloatArray>(folder, components, "size", *writer);
    check_close(read_vtk_sources(floats, {.array = "size"}), expected, 1e-5);
    CHECK_THAT(error_of([&] { read_vtk_sources(floats); }),
               Contains("no array is named :metric, there are 'size': name one"));
    CHECK_THAT(error_of([&] { read_vtk_sources(floats, {.array = "sizes"}); }),
               Contains("no array is named 'sizes', there are 'size': name one"));
}

TEST_CASE("arrays that are no metrics are refused") {
    const ScratchDirectory folder;
    vtkNew<vtkXMLPolyDataWriter> writer;
    CHECK_THAT(error_of([&] {
                   read_vtk_sources(write_vtp<vtkDoubleArray>(folder, 3, ":metric", *writer));
               }),
               Contains("array ':metric' has 3 components: give 1"));
}

TEST_CASE("data of cells are sources at the centres of the cells") {
    const ScratchDirectory folder;
    vtkNew<vtkUnstructuredGrid> grid;
    vtkNew<vtkPoints> points;
    points->SetDataTypeToDouble();
    for (const Point& p :
         {Point(0, 0, 0), Point(4, 0, 0), Point(0, 4, 0), Point(0, 0, 4), Point(4, 4, 4)}) {
        points->InsertNextPoint(p.data());
    }
    grid->SetPoints(points);
    const std::array<vtkIdType, 4> first{0, 1, 2, 3}, second{1, 2, 3, 4};
    grid->InsertNextCell(VTK_TETRA, 4, first.data());
    grid->InsertNextCell(VTK_TETRA, 4, second.data());
    const int components = GENERATE(1, 6, 9);
    std::vector<PointSource> expected = two;
    expected[0].position = {1, 1, 1};
    expected[1].position = {2, 2, 2};
    vtkNew<vtkDoubleArray> values;
    values->SetName("a:metric");
    values->SetNumberOfComponents(components);
    for (PointSource& s : expected) {
        if (components == 1) s.metric = Metric::isotropic(s.metric.xx);
        const auto numbers = components == 1
                                 ? std::array<double, 9>{s.metric.xx}
                                 : numbers_of(s.metric, components == 6 ? vtk_tensor : matrix_rows);
        values->InsertNextTuple(numbers.data());
    }
    grid->GetCellData()->AddArray(values);
    const auto path = folder.path() / "cells.vtu";
    const auto write = [&] {
        vtkNew<vtkXMLUnstructuredGridWriter> writer;
        writer->SetFileName(path.c_str());
        writer->SetInputData(grid);
        writer->Write();
    };
    write();
    check_close(read_vtk_sources(path), expected);
    check_close(read_vtk_sources(path, {.array = "a:metric"}), expected);
    CHECK_THAT(error_of([&] { read_vtk_sources(path, {.array = "b"}); }),
               Contains("no array is named 'b', there are 'a:metric' (of cells): name one"));

    // Points come first, under the same name too.
    vtkNew<vtkDoubleArray> of_points;
    of_points->SetName("a:metric");
    for (int i = 0; i < 5; ++i) of_points->InsertNextValue(0.5 + i);
    grid->GetPointData()->AddArray(of_points);
    write();
    const auto read = read_vtk_sources(path);
    REQUIRE(read.size() == 5);
    CHECK(read[4].metric == Metric::isotropic(4.5));
    grid->GetPointData()->RemoveArray("a:metric");

    if (components == 1) {
        values->SetTuple1(1, -0.5);
        write();
        CHECK_THAT(error_of([&] { read_vtk_sources(path); }), Contains("size 2 is -0.5"));
    }
    grid->GetCellData()->RemoveArray("a:metric");
    write();
    CHECK_THAT(error_of([&] { read_vtk_sources(path); }), Contains("it has no arrays"));
}

TEST_CASE("of several steps in time in a file of VTK the last is read, or the one that is named") {
    const ScratchDirectory folder;
    const auto array = [](int step, const char* h) {
        return fmt::format(
            R"(<DataArray type="Float64" Name="h" format="ascii" TimeStep="{}">{}</DataArray>)",
            step, h);
    };
    const std::string head =
        R"(<VTKFile type="ImageData" version="0.1" byte_order="LittleEndian">)"
        R"(<ImageData TimeValues="0 0.5" WholeExtent="0 1 0 0 0 0" Origin="0 0 0" Spacing="1 1 1">)"
        R"(<Piece Extent="0 1 0 0 0 0"><PointData>)";
    const auto path = folder.file("t.vti", head + array(0, "1 2") + array(1, "3 4") +
                                               "</PointData></Piece></ImageData></VTKFile>");
    std::string said;
    const auto first = [&](std::optional<std::uint64_t> step) {
        said.clear();
        return read_vtk_sources(
                   path,
                   {.array = "h", .step = step, .remark = [&](const std::string& r) { said += r; }})
            .front()
            .metric.xx;
    };
    CHECK(first({}) == 3);
    CHECK_THAT(said, Contains("t.vti: view 'h' has 2 steps in time: the last is taken, number 1"));
    CHECK(first(0) == 1);
    CHECK(first(1) == 3);
    CHECK(said.empty());
    CHECK_THAT(error_of([&] { first(2); }), Contains("has no step 2 in time: name one of 0, 1"));
}

TEST_CASE("legacy files of VTK are read, of all arrays and kinds of data sets") {
    const ScratchDirectory folder;
    const std::string head = "# vtk DataFile Version 3.0\nby hand\nASCII\n";
    const std::string data =
        "POINT_DATA 2\nSCALARS first double\nLOOKUP_TABLE default\n3 4\n"
        "SCALARS h double\nLOOKUP_TABLE default\n0.5 0.25\n"
        "TENSORS t double\n4 0 0\n0 16 0\n0 0 64\n\n1 0 0\n0 1 0\n0 0 1\n"
        "FIELD more 1\nf 1 2 float\n0.125 2\n";
    const std::string grid = GENERATE("DATASET UNSTRUCTURED_GRID\nPOINTS 2 double\n0 0 0 1 0 0\n",
                                      "DATASET POLYDATA\nPOINTS 2 double\n0 0 0 1 0 0\n",
                                      "DATASET STRUCTURED_POINTS\nDIMENSIONS 2 1 1\nORIGIN 0 0 0\n"
                                      "SPACING 1 1 1\n",
                                      "DATASET RECTILINEAR_GRID\nDIMENSIONS 2 1 1\n"
                                      "X_COORDINATES 2 double\n0 1\nY_COORDINATES 1 double\n0\n"
                                      "Z_COORDINATES 1 double\n0\n");
    CAPTURE(grid);
    const auto path = folder.file("a.vtk", head + grid + data);
    const auto read = [&](const char* array) { return read_vtk_sources(path, {.array = array}); };
    CHECK(read("h") == std::vector<PointSource>{{{0, 0, 0}, Metric::isotropic(0.5)},
                                                {{1, 0, 0}, Metric::isotropic(0.25)}});
    CHECK(read("f").back().metric == Metric::isotropic(2));
    CHECK(read("t").front().metric.matrix().isApprox(Metric{0.5, 0.25, 0.125, 0, 0, 0}.matrix(),
                                                     1e-14));
    const auto error = [&](const std::string& text) {
        return error_of([&] { read_vtk_sources(folder.file("b.vtk", text), {.array = "h"}); });
    };
    CHECK_THAT(error("x,y,z,h\n0,0,0,1\n"), Contains("b.vtk: does not start with '# vtk"));
    CHECK_FALSE(error(head + "DATASET NONE\n").empty());
    CHECK_FALSE(error(head + grid + data.substr(0, 60)).empty());
}

TEST_CASE("hidden points and cells are no sources, and make no field") {
    const ScratchDirectory folder;
    vtkNew<vtkImageData> image;
    image->SetDimensions(4, 2, 2);
    const auto h = [](const Point& p) { return p.x() < 3 ? 1 + p.x() : -1; };
    const bool at_points = GENERATE(true, false);
    vtkNew<vtkUnsignedCharArray> marks;
    marks->SetName("vtkGhostType");
    if (at_points) {
        for (vtkIdType i = 0; i < image->GetNumberOfPoints(); ++i) {
            const bool is_hidden = image->GetPoint(i)[0] == 3;
            marks->InsertNextValue(is_hidden ? vtkDataSetAttributes::HIDDENPOINT
                                             : vtkDataSetAttributes::DUPLICATEPOINT);
        }
        image->GetPointData()->AddArray(marks);
    } else {
        vtkNew<vtkDoubleArray> sizes;
        sizes->SetName("c");
        for (const double size : {1.0, 2.0, -1.0}) sizes->InsertNextValue(size);
        for (const int mark : {0, 1, 32}) marks->InsertNextValue(static_cast<unsigned char>(mark));
        image->GetCellData()->AddArray(sizes);
        image->GetCellData()->AddArray(marks);
    }
    write_grid<vtkXMLImageDataWriter>(folder / "h.vti", *image, h);
    std::string said;
    const auto sources = read_vtk_sources(
        folder / "h.vti",
        {.array = at_points ? "h" : "c", .remark = [&](const std::string& r) { said += r; }});
    CHECK(sources.size() == (at_points ? 12 : 2));
    CHECK_THAT(said, Contains(at_points ? "h.vti: 4 hidden points are left out"
                                        : "h.vti: 1 hidden cells are left out"));
    for (const PointSource& s : sources) CHECK(s.metric.xx == std::floor(1 + s.position.x()));
    CHECK_THAT(error_of([&] { read_vtk_field(folder / "h.vti", at_points ? "h" : "c"); }),
               Contains("is hidden"));
}

TEST_CASE("exported leaves, nodes and slices are sources again") {
    const ScratchDirectory folder;
    const auto space = filled(GENERATE("K_oL", "K_oV", "K_L"));
    const auto check = [&](const std::vector<PointSource>& sources, std::size_t count) {
        CHECK(sources.size() == count);
        for (const PointSource& s : sources) {
            Metric m;
            space->sample({&s.position, 1}, {&m, 1});
            CHECK(s.metric.matrix().isApprox(m.matrix(), 1e-10));
        }
    };
    write_leaves(folder / "leaves.vtu", *space);
    check(read_vtk_sources(folder / "leaves.vtu"), space->footprint().cells);
    write_slice(folder / "slice.vti", *space, domain, {.at = 0.3, .samples = 31});
    const auto slice = read_vtk_sources(folder / "slice.vti");
    check(slice, 31 * 31);
    for (const PointSource& s : slice) CHECK(s.position.z() == Approx(0.3));
    const auto lengths = read_vtk_sources(folder / "slice.vti", {.array = "h_min"});
    for (std::size_t i = 0; i < slice.size(); ++i) {
        CHECK(lengths[i].metric.xx == Approx(eigen_frame(slice[i].metric).lengths[0]));
    }
}

TEST_CASE("exported leaves are the field again, in each leaf the metric at its centre") {
    const ScratchDirectory folder;
    const auto space = filled(GENERATE("K_oL", "K_L", "K_oV"));
    write_leaves(folder / "leaves.vtu", *space);
    const AnalyticField field = read_vtk_field(folder / "leaves.vtu");
    CHECK(field.field->domain() == domain);
    std::vector<Point> x;
    for (int i = 0; i < 3000; ++i) {
        const auto part = [&](double irrational) { return std::fmod(irrational * (i + 1), 1.0); };
        x.push_back(domain.low + Vector(part(0.7548776662), part(0.5698402909), part(0.4301597090))
                                     .cwiseProduct(domain.edges()));
    }
    x.emplace_back(9, -9, 9);  // outside: as at the corner
    std::vector<Point> centres;
    for (const Point& p : x) centres.push_back(space->cell_at(p)->centre());
    std::vector<Metric> own(x.size()), read(x.size());
    space->sample(centres, own);
    field.field->sample(x, read);
    double finest = 1e9;
    for (std::size_t i = 0; i < x.size(); ++i) {
        CHECK(read[i].matrix().isApprox(own[i].matrix(), 1e-10));
        finest = std::min(finest, eigen_frame(own[i]).lengths[0]);
    }
    CHECK(field.finest_length <= finest * (1 + 1e-10));
}

TEST_CASE("between points with metrics a field is linear") {
    const ScratchDirectory folder;
    vtkNew<vtkImageData> image;
    image->SetDimensions(4, 3, 5);
    image->SetOrigin(-1, 0, 1);
    image->SetSpacing(0.5, 1, 0.25);
    const auto length_at = [](const Point& p) {
        return 1 + 0.1 * p.x() - 0.2 * p.y() + 0.3 * p.z();
    };
    vtkNew<vtkDoubleArray> sizes;
    sizes->SetName("h");
    for (vtkIdType i = 0; i < image->GetNumberOfPoints(); ++i) {
        sizes->InsertNextValue(length_at(Point(image->GetPoint(i))));
    }
    image->GetPointData()->AddArray(sizes);
    const auto path = folder / "h.vti";
    vtkNew<vtkXMLImageDataWriter> writer;
    writer->SetFileName(path.c_str());
    writer->SetInputData(image);
    writer->Write();
    const auto field = read_vtk_field(path, "h").field;
    for (const Point& p : {Point(-0.9, 0.3, 1.1), Point(0.4, 1.7, 1.9), Point(0, 1, 1.5)}) {
        CHECK(metric_at(*field, p).xx == Approx(length_at(p)).epsilon(1e-12));
    }
    CHECK(metric_at(*field, {9, 1, 1.5}).xx == Approx(length_at({0.5, 1, 1.5})).epsilon(1e-12));
    CHECK_THAT(error_of([&] { read_vtk_field(path); }), Contains("'h': name one (--field-grid)"));

    write_nodes(folder / "nodes.vtu", *filled("K_oV"));
    CHECK_THAT(error_of([&] { read_vtk_field(folder / "nodes.vtu"); }),
               Contains("cell 1 has no volume"));
}

TEST_CASE("the axes of an image may be turned, exchanged and mirrored") {
    const ScratchDirectory folder;
    const double unit = GENERATE(1.0, 1e-7);
    const auto turn = [](double degrees, const Vector& axis) {
        return Eigen::AngleAxisd(degrees * 3.14159265358979 / 180, axis.normalized()).matrix();
    };
    const Eigen::Matrix3d exchanged = (Eigen::Matrix3d() << 0, 1, 0, 1, 0, 0, 0, 0, 1).finished();
    const Eigen::Matrix3d axes[] = {
        Eigen::Matrix3d::Identity(), exchanged,           Eigen::Vector3d(1, 1, -1).asDiagonal(),
        turn(120, {1, 1, 1}),        turn(90, {0, 1, 0}), turn(33, {1, 2, -0.5})};
    const Eigen::Matrix3d& d = axes[GENERATE(range(0, 6))];
    vtkNew<vtkImageData> image;
    image->SetDimensions(4, 3, 5);
    image->SetExtent(-1, 2, 3, 5, 0, 4);
    image->SetOrigin(-unit, 0.2 * unit, 3 * unit);
    image->SetSpacing(0.5 * unit, unit, 0.25 * unit);
    image->SetDirectionMatrix(d(0, 0), d(0, 1), d(0, 2), d(1, 0), d(1, 1), d(1, 2), d(2, 0),
                              d(2, 1), d(2, 2));
    const auto length_at = [&](const Point& p) {
        return 9 + (0.1 * p.x() - 0.2 * p.y() + 0.3 * p.z()) / unit;
    };
    const auto point_at = [&](double i, double j, double k) {
        Point p;
        const std::array<double, 3> index{i, j, k};
        image->TransformContinuousIndexToPhysicalPoint(index.data(), p.data());
        return p;
    };
    write_grid<vtkXMLImageDataWriter>(folder / "h.vti", *image, length_at);
    const auto field = read_vtk_field(folder / "h.vti", "h").field;
    std::mt19937 random(1);
    const auto between = [&](double low, double high) {
        return std::uniform_real_distribution(low, high)(random);
    };
    for (int n = 0; n < 200; ++n) {
        const Point p = point_at(between(-1, 2), between(3, 5), between(0, 4));
        CHECK(metric_at(*field, p).xx == Approx(length_at(p)).epsilon(1e-9));
        CHECK(field->domain().contains(p));
    }
    const Point corner = point_at(2, 5, 4);
    CHECK(metric_at(*field, point_at(2.1, 5.2, 4.3)).xx == Approx(length_at(corner)).epsilon(1e-9));
}

/// Cells of a kind in [0, 2]^3: as VTK makes them, or one, slanted, from its parametric form.
vtkSmartPointer<vtkUnstructuredGrid> cells_of(int kind) {
    vtkNew<vtkGenericCell> cell;
    const bool is_free = kind == VTK_CONVEX_POINT_SET || kind == VTK_POLYHEDRON;
    cell->SetCellType(is_free ? VTK_HEXAHEDRON : kind);
    if (kind >= VTK_LAGRANGE_CURVE) {
        vtkNew<vtkCellTypeSource> cells;
        cells->SetCellType(kind);
        cells->SetBlocksDimensions(2, 2, 2);
        cells->SetOutputPrecision(vtkAlgorithm::DOUBLE_PRECISION);
        cells->Update();
        vtkSmartPointer<vtkUnstructuredGrid> grid = cells->GetOutput();
        while (grid->GetPointData()->GetNumberOfArrays() > 0) grid->GetPointData()->RemoveArray(0);
        return grid;
    }
    vtkNew<vtkUnstructuredGrid> grid;
    vtkNew<vtkPoints> points;
    points->SetDataTypeToDouble();
    std::vector<vtkIdType> corners;
    Eigen::Matrix3d slant;
    slant << 1.6, 0.2, 0.1, 0, 1.5, 0.2, 0.1, 0, 1.7;
    if (kind == VTK_VOXEL) slant = Eigen::Vector3d(1.6, 1.5, 1.7).asDiagonal();
    const double* places = cell->GetParametricCoords();
    for (vtkIdType i = 0; i < cell->GetNumberOfPoints(); ++i) {
        corners.push_back(i);
        points->InsertNextPoint(Point(slant * Point(places + 3 * i)).data());
    }
    grid->SetPoints(points);
    if (kind == VTK_POLYHEDRON) {
        const std::array<vtkIdType, 30> faces{4, 0, 3, 2, 1, 4, 4, 5, 6, 7, 4, 0, 1, 5, 4,
                                              4, 1, 2, 6, 5, 4, 2, 3, 7, 6, 4, 3, 0, 4, 7};
        grid->InsertNextCell(kind, 8, corners.data(), 6, faces.data());
    } else {
        grid->InsertNextCell(kind, static_cast<vtkIdType>(corners.size()), corners.data());
    }
    return grid;
}

TEST_CASE("in cells of all kinds a field is what VTK's own probe finds") {
    const ScratchDirectory folder;
    const int kind = GENERATE(VTK_TETRA, VTK_VOXEL, VTK_HEXAHEDRON, VTK_WEDGE, VTK_PYRAMID,
                              VTK_PENTAGONAL_PRISM, VTK_HEXAGONAL_PRISM, VTK_QUADRATIC_TETRA,
                              VTK_QUADRATIC_HEXAHEDRON, VTK_QUADRATIC_WEDGE, VTK_QUADRATIC_PYRAMID,
                              VTK_TRIQUADRATIC_HEXAHEDRON, VTK_QUADRATIC_LINEAR_WEDGE,
                              VTK_BIQUADRATIC_QUADRATIC_WEDGE, VTK_BIQUADRATIC_QUADRATIC_HEXAHEDRON,
                              VTK_TRIQUADRATIC_PYRAMID, VTK_CONVEX_POINT_SET, VTK_POLYHEDRON,
                              VTK_LAGRANGE_TETRAHEDRON, VTK_LAGRANGE_HEXAHEDRON, VTK_LAGRANGE_WEDGE,
                              VTK_BEZIER_TETRAHEDRON, VTK_BEZIER_HEXAHEDRON, VTK_BEZIER_WEDGE);
    CAPTURE(kind);
    const auto made = cells_of(kind);
    vtkUnstructuredGrid& grid = *made;
    REQUIRE(grid.GetNumberOfCells() > 0);
    REQUIRE(grid.GetCellType(0) == kind);
    while (grid.GetPointData()->GetNumberOfArrays() > 0) grid.GetPointData()->RemoveArray(0);
    write_grid<vtkXMLUnstructuredGridWriter>(folder / "h.vtu", grid, [](const Point& p) {
        return 3 + std::sin(2 * p.x()) - 0.5 * std::cos(3 * p.y() + p.z());
    });
    std::mt19937 random(1);
    std::uniform_real_distribution between(0.0, 2.0);
    vtkNew<vtkPoints> places;
    places->SetDataTypeToDouble();
    for (int n = 0; n < 300; ++n) {
        const double x = between(random), y = between(random), z = between(random);
        places->InsertNextPoint(x, y, z);
    }
    vtkNew<vtkPolyData> set;
    set->SetPoints(places);
    vtkNew<vtkProbeFilter> probe;
    probe->SetInputData(set);
    probe->SetSourceData(&grid);
    probe->ComputeToleranceOff();  // by default, values near a cell are extrapolated from it
    probe->SetTolerance(1e-12);
    probe->Update();
    const auto field = read_vtk_field(folder / "h.vtu", "h").field;
    vtkPointData& found = *probe->GetOutput()->GetPointData();
    // Shape functions of higher order may go below all values: the field does not.
    const double finest = read_vtk_field(folder / "h.vtu", "h").finest_length;
    std::size_t compared = 0;
    for (vtkIdType i = 0; i < places->GetNumberOfPoints(); ++i) {
        const double expected = value_at(found, "h", i);
        if (value_at(found, probe->GetValidPointMaskArrayName(), i) == 0) continue;
        const double h = metric_at(*field, Point(places->GetPoint(i))).xx;
        CHECK(h >= finest);
        if (expected < finest) continue;
        // To VTK's iterations for parametric coordinates.
        CHECK(h == Approx(expected).epsilon(1e-4));
        ++compared;
    }
    CHECK(compared > 20);
}

TEST_CASE("cells may be as small as a unit makes them") {
    const ScratchDirectory folder;
    const double unit = GENERATE(1e-9, 1e9);
    const int kind = GENERATE(VTK_TETRA, VTK_VOXEL, VTK_HEXAHEDRON, VTK_WEDGE, VTK_PYRAMID,
                              VTK_QUADRATIC_TETRA, VTK_QUADRATIC_HEXAHEDRON);
    CAPTURE(kind, unit);
    const auto grid = cells_of(kind);
    vtkPoints& points = *grid->GetPoints();
    std::vector<Point> places;
    for (vtkIdType i = 0; i < points.GetNumberOfPoints(); ++i) {
        const Point p = unit * Point(points.GetPoint(i));
        points.SetPoint(i, p.data());
        places.push_back(p);
    }
    const auto length_at = [&](const Point& p) {
        return 9 + (0.1 * p.x() - 0.2 * p.y() + 0.3 * p.z()) / unit;
    };
    write_grid<vtkXMLUnstructuredGridWriter>(folder / "h.vtu", *grid, length_at);
    const auto field = read_vtk_field(folder / "h.vtu", "h").field;
    const Point centre =
        std::accumulate(places.begin(), places.end(), Point(0, 0, 0)) / double(places.size());
    for (const Point& corner : places) {
        const Point p = 0.7 * centre + 0.3 * corner;
        CHECK(metric_at(*field, p).xx == Approx(length_at(p)).epsilon(1e-5));
    }
}

TEST_CASE("an image whose axes are in a plane is refused") {
    const ScratchDirectory folder;
    vtkNew<vtkImageData> image;
    image->SetDimensions(2, 2, 2);
    write_grid<vtkXMLImageDataWriter>(folder / "h.vti", *image, [](const Point&) { return 1; });
    std::string text = read_binary_file(folder / "h.vti");
    const std::string axes = "Direction=\"1 0 0 0 1 0 0 0 1\"";
    REQUIRE_THAT(text, Contains(axes));
    text.replace(text.find(axes), axes.size(), "Direction=\"1 0 0 0 1 0 0 0 0\"");
    const auto path = folder.file("flat.vti", text);
    CHECK_THAT(error_of([&] { read_vtk_field(path, "h"); }), Contains("no basis of space"));
}

}  // namespace controlspace::vtk_test
