// SPDX-License-Identifier: Apache-2.0
#include <limits>

#include "case_of_each.h"
#include "controlspace/baselines/catalogue.h"
#include "controlspace/fields/formula_field.h"
#include "controlspace/io/read_vdb.h"
#include "controlspace/io/write_vdb.h"
#include "controlspace/measure/access_time.h"
#include "controlspace/metric/nonconformity.h"
#include "editable_space.h"
#include "export/fixtures.h"
#include "fields/values.h"

namespace controlspace::read_vdb_field_test {

namespace fs = std::filesystem;

namespace {

/// Centres of n^3 cells of the two-cube.
std::vector<Point> centres(int n) {
    std::vector<Point> points;
    for (int i = 0; i < n * n * n; ++i) {
        const Vector cell(i % n, i / n % n, i / n / n);
        points.push_back((cell.array() + 0.5) * 2 / n - 1);
    }
    return points;
}

double largest_relative_difference(const Metric& a, const Metric& b) {
    const double scale = mean_length(b);
    return (a.matrix() - b.matrix()).cwiseAbs().maxCoeff() / scale;
}

}  // namespace

TEST_CASE("what was written comes back at all voxels' centres, to the precision of floats") {
    const ScratchDirectory folder;
    const fs::path path = folder.path() / "field.vdb";
    const auto compression =
        GENERATE(VdbCompression::blosc, VdbCompression::zip, VdbCompression::none);
    write_vdb(path, FormulaField(wavy), two_cube,
              {.voxel = 0.1, .tolerance = 0, .compression = compression});
    const AnalyticField read = read_vdb_field(path);
    CHECK((read.field->domain().low - two_cube.low).norm() < 1e-12);
    CHECK((read.field->domain().high - two_cube.high).norm() < 1e-12);
    const std::vector<Point> points = centres(20);
    std::vector<Metric> metrics(points.size());
    read.field->sample(points, metrics);
    double finest = 1;
    for (std::size_t i = 0; i < points.size(); ++i) {
        const Metric wanted = wavy(points[i]);
        REQUIRE(largest_relative_difference(metrics[i], wanted) < 1e-6);
        finest = std::min(finest, eigen_frame(wanted).lengths[0]);
    }
    CHECK(read.finest_length == Approx(finest).epsilon(1e-6));
}

CASE_OF_EACH(entry, structures(), "every structure comes back as it answered") {
    const ScratchDirectory folder;
    const fs::path path = folder.path() / "field.vdb";
    const PointSource sources[] = {{{0.2, 0.1, 0}, Metric::isotropic(0.1)},
                                   {{-0.5, 0, 0.3}, Metric{0.2, 0.3, 0.4, 0.01, 0.02, 0.03}}};
    const std::vector<Point> points = centres(16);
    std::vector<Metric> read(points.size());
    std::vector<Metric> wanted(points.size());
    const auto space = editable(entry.make({.domain = two_cube, .finest_length = 0.1}));
    space->insert(std::span<const PointSource>(sources));
    space->grade({});
    space->sample(points, wanted);
    write_vdb(path, *space, {.voxel = 0.125, .tolerance = 0});
    read_vdb_field(path).field->sample(points, read);
    double exact = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
        exact = std::max(exact, largest_relative_difference(read[i], wanted[i]));
    }
    CHECK(exact < 1e-6);

    write_vdb(path, *space, {.voxel = 0.125, .tolerance = 0.02});
    read_vdb_field(path).field->sample(points, read);
    double delta = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
        delta = std::max(delta, nonconformity(read[i], wanted[i]));
    }
    CHECK(delta <= 0.02 + 1e-5);
}

TEST_CASE("between centres fields are linear, and beyond the box as at its nearest point") {
    const ScratchDirectory folder;
    const fs::path path = folder.path() / "field.vdb";
    const auto linear = [](const Point& x) {
        return Metric::isotropic(0.5 + 0.1 * x.x() - 0.05 * x.z());
    };
    write_vdb(path, FormulaField(linear), two_cube, {.voxel = 0.1, .tolerance = 0});
    const auto field = read_vdb_field(path).field;
    for (const Point& x : {Point(0.123, 0.456, -0.789), Point(0, 0, 0), Point(-0.5, 0.9, 0.31)}) {
        CHECK(value_at(*field, x).xx == Approx(linear(x).xx).epsilon(1e-6));
    }
    CHECK(value_at(*field, {7, 0.05, 0.05}) == value_at(*field, {0.95, 0.05, 0.05}));
    const double nan = std::numeric_limits<double>::quiet_NaN();
    CHECK(is_positive_definite(value_at(*field, {nan, nan, nan})));
}

TEST_CASE("isotropic metrics are written as lengths, once, and read as the field") {
    const ScratchDirectory folder;
    const fs::path path = folder.path() / "field.vdb";
    const FormulaField field(around_sphere);
    write_vdb(path, field, two_cube, {.voxel = 0.1, .tolerance = 0});
    openvdb::io::File file(path.string());
    file.open();
    std::vector<std::string> names;
    for (auto name = file.beginName(); name != file.endName(); ++name) names.push_back(*name);
    CHECK(names == std::vector<std::string>{"density", "h_min"});
    const fs::path all = folder.path() / "all.vdb";
    write_vdb(all, field, two_cube,
              {.voxel = 0.1, .tolerance = 0, .grids = {"metric_diag", "metric_off"}});
    const auto read = read_vdb_field(path).field;
    const auto tensors = read_vdb_field(all).field;
    for (const Point& x : random_points(two_cube, 1000, 3)) {
        const Metric m = value_at(*read, x);
        REQUIRE(is_isotropic(m));
        REQUIRE(m.xx == Approx(value_at(*tensors, x).xx).epsilon(1e-6));
    }
    // Smallest lengths of tensors are not the field.
    write_vdb(path, FormulaField(wavy), two_cube, {.voxel = 0.1, .grids = {"density", "h_min"}});
    CHECK_THAT(error_of([&] { read_vdb_field(path); }), Catch::Contains("no grid 'metric_diag'"));
}

TEST_CASE("voxels that are too small for OpenVDB are written in another unit, and read in theirs") {
    const ScratchDirectory folder;
    const double unit = GENERATE(1e-6, 1e-9, 3e-4);
    const Box small{unit * Point(1, 2, 3), unit * Point(3, 4, 6)};
    const auto metric_at = [&](const Point& p) {
        const Point x = p / unit;
        return unit * Metric{0.3 + 0.01 * x.x(), 0.4, 0.5 + 0.02 * x.z(), 0.02, -0.03, 0.05};
    };
    const FormulaField field(metric_at);
    const auto path = folder.path() / "small.vdb";
    const VdbReport report = write_vdb(path, field, small, {.voxel = unit / 10, .tolerance = 0});
    CHECK(report.voxel == Approx(unit / 10));
    CHECK(report.finest > 0.1 * unit);
    CHECK(report.finest < report.coarsest * (1 + 1e-9));
    CHECK(report.coarsest < unit);
    CHECK((report.scale > 1) == (unit < 1e-4));
    const AnalyticField read = read_vdb_field(path, {});
    CHECK((read.field->domain().low - small.low).norm() < 1e-5 * unit);
    CHECK((read.field->domain().high - small.high).norm() < 1e-5 * unit);
    CHECK(read.finest_length == Approx(report.finest).epsilon(1e-5));
    for (const Vector& t : {Vector(0.2, 0.3, 0.4), Vector(0.9, 0.1, 0.5), Vector(0.5, 0.5, 0.5)}) {
        const Point p = small.low + t.cwiseProduct(small.edges());
        CHECK(sample_at(*read.field, p).matrix().isApprox(metric_at(p).matrix(), 1e-4));
    }
    const auto painted =
        read_vdb_field(path, {.grid = "density", .density = {{report.finest, report.coarsest}}});
    CHECK(painted.finest_length == Approx(report.finest).epsilon(1e-5));
    const double h = sample_at(*painted.field, small.centre()).xx;
    CHECK(h == Approx(eigen_frame(metric_at(small.centre())).lengths[0]).epsilon(1e-3));
    for (const PointSource& s : read_vdb_sources(path, {.grid = "density", .h = unit})) {
        CHECK(small.contains(s.position));
        CHECK(s.metric == Metric::isotropic(unit));
    }
}

TEST_CASE("our own density leads back to the smallest length") {
    const ScratchDirectory folder;
    const fs::path path = folder.path() / "field.vdb";
    const VdbReport report =
        write_vdb(path, FormulaField(wavy), two_cube, {.voxel = 0.1, .tolerance = 0});
    const AnalyticField read = read_vdb_field(
        path, {.grid = "density", .density = DensitySizes{report.finest, report.coarsest}});
    for (const Point& x : centres(20)) {
        REQUIRE(value_at(*read.field, x).xx ==
                Approx(eigen_frame(wavy(x)).lengths[0]).epsilon(1e-5));
    }
}

}  // namespace controlspace::read_vdb_field_test
