// SPDX-License-Identifier: Apache-2.0
#include "controlspace/io/write_vdb.h"

#include <openvdb/points/PointDataGrid.h>
#include <signal.h>
#include <sys/resource.h>
#include <tbb/global_control.h>

#include <cstdlib>
#include <map>
#include <sstream>

#include "controlspace/baselines/catalogue.h"
#include "controlspace/io/metric_grids.h"
#include "controlspace/metric/nonconformity.h"
#include "controlspace/sources/source_columns.h"
#include "controlspace/space/control_space_file.h"
#include "export/fixtures.h"

namespace controlspace::write_vdb_test {

using Catch::Matchers::Contains;
namespace fs = std::filesystem;

namespace {

const Box oblong{{-1, 0, 2}, {1, 0.5, 3}};

VdbReport write(const fs::path& path, const VdbOptions& options) {
    return write_vdb(path, FormulaField(wavy), oblong, options);
}

bool holds_no_file(const fs::path& folder) { return fs::is_empty(folder); }

}  // namespace

TEST_CASE("grids stand in the world, and hold the field at the voxels' centres") {
    const ScratchDirectory folder;
    const fs::path path = folder.path() / "field.vdb";
    const VdbReport report = write(path, {.voxel = 0.1, .tolerance = 0});
    CHECK(report.counts == std::array{20, 5, 10});
    CHECK(report.file == fs::file_size(path));
    const auto diagonal = read_grid<openvdb::Vec3SGrid>(path, "metric_diag");
    const auto off_diagonal = read_grid<openvdb::Vec3SGrid>(path, "metric_off");
    const auto smallest = read_grid<openvdb::FloatGrid>(path, "h_min");
    const auto density = read_grid<openvdb::FloatGrid>(path, "density");
    CHECK(diagonal->activeVoxelCount() == 20 * 5 * 10);
    CHECK(diagonal->voxelSize().x() == Approx(0.1));
    std::size_t voxels = 0;
    for (auto d = diagonal->cbeginValueOn(); d; ++d) {
        const openvdb::Coord ijk = d.getCoord();
        const openvdb::Vec3d world = diagonal->indexToWorld(ijk);
        const Metric m = wavy({world.x(), world.y(), world.z()});
        const openvdb::Vec3s o = off_diagonal->tree().getValue(ijk);
        const double got[] = {(*d)[0], (*d)[1], (*d)[2], o[0], o[1], o[2]};
        const double wanted[] = {m.xx, m.yy, m.zz, m.xy, m.xz, m.yz};
        for (int i = 0; i < 6; ++i) REQUIRE(got[i] == Approx(wanted[i]).epsilon(1e-6).margin(1e-8));
        const double h = eigen_frame(m).lengths[0];
        REQUIRE(smallest->tree().getValue(ijk) == Approx(h).epsilon(1e-6));
        REQUIRE(density->tree().getValue(ijk) ==
                Approx(density_of(h, report.finest, report.coarsest)).margin(1e-6));
        ++voxels;
    }
    CHECK(voxels == 1000);
    // Whole indices are centres: the domain's low corner lies half a voxel before the first one.
    const openvdb::Vec3d first = diagonal->indexToWorld(openvdb::Coord(0));
    CHECK(first.x() == Approx(-0.95));
    CHECK(first.y() == Approx(0.05));
    CHECK(first.z() == Approx(2.05));
    CHECK(density->metaValue<double>("h_at_1") == report.finest);
    CHECK(density->metaValue<double>("h_at_0") == report.coarsest);
}

TEST_CASE("a file keeps Houdini's and Blender's conventions") {
    const ScratchDirectory folder;
    const fs::path path = folder.path() / "field.vdb";
    write(path, {.voxel = 0.125, .notes = {{"structure", "K_oV"}, {"g_r", 1.25}}});
    openvdb::io::File file(path.string());
    file.open(false);
    const std::map<std::string, std::string> types{
        {"density", "float"}, {"h_min", "float"},       {"h_max", "float"},
        {"h_mean", "float"},  {"anisotropy", "float"},  {"sizes", "vec3s"},
        {"e1", "vec3s"},      {"metric_diag", "vec3s"}, {"metric_off", "vec3s"}};
    std::size_t grids = 0;
    for (auto name = file.beginName(); name != file.endName(); ++name, ++grids) {
        CAPTURE(*name);
        REQUIRE(types.count(*name) == 1);
        const auto grid = file.readGrid(*name);
        CHECK(grid->getName() == *name);
        CHECK(grid->valueType() == types.at(*name));
        CHECK(grid->type() == "Tree_" + types.at(*name) + "_5_4_3");
        CHECK(grid->getGridClass() ==
              (*name == "density" ? openvdb::GRID_FOG_VOLUME : openvdb::GRID_UNKNOWN));
        CHECK(grid->getVectorType() ==
              (*name == "e1" ? openvdb::VEC_CONTRAVARIANT_RELATIVE : openvdb::VEC_INVARIANT));
        CHECK(grid->transform().isLinear());
        CHECK(grid->transform().hasUniformScale());
        CHECK(grid->isInWorldSpace());
        CHECK(grid->getCreator() == "controlspace");
        CHECK(grid->metaValue<std::string>("structure") == "K_oV");
        CHECK(grid->metaValue<double>("g_r") == 1.25);
        CHECK(grid->metaValue<openvdb::Vec3d>("domain_low") == openvdb::Vec3d(-1, 0, 2));
        CHECK(grid->metaValue<openvdb::Vec3d>("domain_high") == openvdb::Vec3d(1, 0.5, 3));
        CHECK(grid->metaValue<double>("tolerance") == 0.01);
    }
    CHECK(grids == types.size());
    const auto density = openvdb::gridPtrCast<openvdb::FloatGrid>(file.readGrid("density"));
    for (auto value = density->cbeginValueOn(); value; ++value) {
        REQUIRE((*value >= 0 && *value <= 1));
    }
}

TEST_CASE("vdb_print lists the grids") {
    if (std::system("command -v vdb_print >/dev/null") != 0) {
        WARN("skipped: no vdb_print (package libopenvdb-tools)");
        SUCCEED("no vdb_print");
        return;
    }
    const ScratchDirectory folder;
    write(folder.path() / "field.vdb", {.voxel = 0.125});
    const std::string command = "cd " + folder.path().string() + " && vdb_print -l field.vdb >out";
    REQUIRE(std::system(command.c_str()) == 0);
    std::ostringstream text;
    text << std::ifstream(folder.path() / "out").rdbuf();
    for (const MetricGrid& grid : metric_grids()) {
        CHECK_THAT(text.str(), Contains("Name: " + std::string(grid.name)));
    }
    CHECK_THAT(text.str(), Contains("class: fog volume") && Contains("vector_type: invariant") &&
                               Contains("voxel size: 0.125"));
}

TEST_CASE("tiles stand where the field hardly varies, voxels keep to the tolerance") {
    const ScratchDirectory folder;
    const fs::path path = folder.path() / "field.vdb";
    // Steep at the sphere, gentle elsewhere.
    const auto at = [](const Point& x) {
        const double d = std::abs(x.norm() - 0.8);
        return Metric::isotropic(0.02 + std::min(d, 0.03 + 0.002 * d));
    };
    const VdbOptions every_voxel{.voxel = 1.0 / 32, .tolerance = 0};
    const VdbReport all = write_vdb(path, FormulaField(at), two_cube, every_voxel);
    const VdbReport adaptive = write_vdb(path, FormulaField(at), two_cube, {.voxel = 1.0 / 32});
    CHECK(all.kept == 1);
    CHECK(adaptive.kept < 0.9);
    CHECK(adaptive.file < all.file / 2);
    CHECK(adaptive.memory < all.memory);
    const auto lengths = read_grid<openvdb::FloatGrid>(path, "h_min");
    CHECK(lengths->activeVoxelCount() == 64 * 64 * 64);
    CHECK(lengths->tree().activeTileCount() > 0);
    double largest = 0;
    openvdb::Coord ijk;
    for (ijk.x() = 0; ijk.x() < 64; ++ijk.x()) {
        for (ijk.y() = 0; ijk.y() < 64; ++ijk.y()) {
            for (ijk.z() = 0; ijk.z() < 64; ++ijk.z()) {
                const openvdb::Vec3d x = lengths->indexToWorld(ijk);
                const double factor = lengths->tree().getValue(ijk) / at({x.x(), x.y(), x.z()}).xx;
                largest = std::max({largest, factor, 1 / factor});
            }
        }
    }
    CHECK(largest <= 1.01 + 1e-6);
    CHECK(largest > 1.003);
}

TEST_CASE("where all is equal, blocks at the border end with the domain, and tiles are densities") {
    // Lengths of 2 in the low half, of 1 beyond a plane that lies between blocks.
    const auto halves = [](const Point& x) { return Metric::isotropic(x.x() < 0.8 ? 2 : 1); };
    const ScratchDirectory folder;
    const fs::path path = folder.path() / "field.vdb";
    write_vdb(path, FormulaField(halves), {{0, 0, 0}, {2, 1, 1.3}}, {.voxel = 0.1});
    for (const std::string name : {"h_min", "density"}) {
        const auto grid = read_grid<openvdb::FloatGrid>(path, name);
        CAPTURE(name);
        CHECK(grid->activeVoxelCount() == 20 * 10 * 13);
        CHECK(grid->evalActiveVoxelBoundingBox() == openvdb::CoordBBox({0, 0, 0}, {19, 9, 12}));
        CHECK(grid->tree().activeTileCount() > 0);
    }
    // 1 at the smallest length, 0 at the largest, in tiles too.
    const auto density = read_grid<openvdb::FloatGrid>(path, "density");
    for (auto value = density->cbeginValueOn(); value; ++value) {
        REQUIRE(*value == (value.getCoord().x() < 8 ? 0 : 1));
    }
}

TEST_CASE("compression and halves change the file, not what it says") {
    const ScratchDirectory folder;
    const auto sum = [&](const VdbOptions& options) {
        const fs::path path = folder.path() / "field.vdb";
        write(path, options);
        double total = 0;
        const auto grid = read_grid<openvdb::FloatGrid>(path, "h_max");
        for (auto value = grid->cbeginValueOn(); value; ++value) {
            total += *value * static_cast<double>(value.getVoxelCount());
        }
        return total;
    };
    const double blosc = sum({.voxel = 0.05});
    CHECK(sum({.voxel = 0.05, .compression = VdbCompression::zip}) == blosc);
    CHECK(sum({.voxel = 0.05, .compression = VdbCompression::none}) == blosc);
    const auto whole = write(folder.path() / "whole.vdb", {.voxel = 0.05, .tolerance = 0}).file;
    CHECK(sum({.voxel = 0.05, .half = true}) == Approx(blosc).epsilon(1e-3));
    const auto halved =
        write(folder.path() / "half.vdb", {.voxel = 0.05, .tolerance = 0, .half = true}).file;
    CHECK(10 * halved < 7 * whole);
}

TEST_CASE("the number of threads does not matter") {
    const ScratchDirectory folder;
    const auto values = [&](std::size_t threads) {
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
        const fs::path path = folder.path() / "field.vdb";
        write_vdb(path, FormulaField(around_sphere), two_cube, {.voxel = 0.05});
        std::vector<float> all;
        const auto grid = read_grid<openvdb::FloatGrid>(path, "density");
        for (auto value = grid->cbeginValueOn(); value; ++value) all.push_back(*value);
        return all;
    };
    CHECK(values(1) == values(4));
}

TEST_CASE("sources become points with their metrics") {
    const ScratchDirectory folder;
    const fs::path path = folder.path() / "field.vdb";
    const std::vector<PointSource> sources = {
        {{-0.5, 0.25, 2.5}, {0.1, 0.2, 0.3, 0.01, 0.02, 0.03}},
        {{0.75, 0.125, 2.25}, Metric::isotropic(0.5)}};
    // Options keep what they are given: columns make arrays as they are asked.
    VdbOptions options;
    options.voxel = 0.1;
    options.grids = {"density"};
    options.sources = columns_of(sources).all();
    write(path, options);
    const auto grid = read_grid<openvdb::points::PointDataGrid>(path, "sources");
    REQUIRE(grid);
    std::size_t points = 0;
    for (auto leaf = grid->tree().cbeginLeaf(); leaf; ++leaf) {
        using openvdb::points::AttributeHandle;
        const AttributeHandle<openvdb::Vec3f> position(leaf->constAttributeArray("P"));
        const AttributeHandle<float> size(leaf->constAttributeArray("pscale"));
        const AttributeHandle<openvdb::Vec3f> off(leaf->constAttributeArray("metric_off"));
        for (auto i = leaf->beginIndexOn(); i; ++i, ++points) {
            const openvdb::Vec3d x =
                grid->indexToWorld(openvdb::Vec3d(position.get(*i)) + i.getCoord().asVec3d());
            const PointSource& source = sources[x.x() < 0 ? 0 : 1];
            CHECK((Point(x.x(), x.y(), x.z()) - source.position).norm() < 1e-6);
            CHECK(size.get(*i) == Approx(eigen_frame(source.metric).lengths[0]));
            CHECK(off.get(*i).x() == Approx(source.metric.xy));
        }
    }
    CHECK(points == 2);
}

TEST_CASE("a picture of a field is not taken for the field") {
    const ScratchDirectory folder;
    const fs::path path = folder.path() / "picture.vdb";
    write(path, {.voxel = 0.25});
    CHECK_FALSE(holds_control_space(path));
    CHECK_THAT(error_of([&] { load_control_space(path, structures()); }),
               Contains("no control space"));
}

TEST_CASE("options out of range are refused, and nothing is written") {
    const ScratchDirectory folder;
    const fs::path path = folder.path() / "field.vdb";
    const auto error = [&](const VdbOptions& options) {
        return error_of([&] { write(path, options); });
    };
    CHECK_THAT(error({.grids = {"h_min", "speed"}}),
               Contains("unknown grid 'speed'") && Contains("metric_diag"));
    CHECK_THAT(error({.tolerance = -1}), Contains("tolerance"));
    CHECK_THAT(error({.voxel = -1}), Contains("voxel"));
    CHECK_THAT(error({.voxel = 0.01, .tolerance = 0, .max_bytes = 100000}),
               Contains("--max-memory"));
    const auto scaled = [&](double factor, bool halves) {
        const FormulaField field([&](const Point& x) { return factor * wavy(x); });
        return error_of([&] { write_vdb(path, field, oblong, {.voxel = 0.1, .half = halves}); });
    };
    CHECK_THAT(scaled(1e-5, true), Contains("--half"));
    CHECK_THAT(scaled(1e6, true), Contains("--half"));
    CHECK_THAT(scaled(1e40, false), Contains("unit of length"));
    CHECK_THAT(scaled(1e-40, false), Contains("unit of length"));
    CHECK(holds_no_file(folder.path()));
}

TEST_CASE("a file that cannot be written is named, and nothing is left of it") {
    const ScratchDirectory folder;
    const auto error = [&](const fs::path& path) {
        return error_of([&] { write(path, {.voxel = 0.05, .tolerance = 0}); });
    };
    CHECK_THAT(error(folder.path()), Contains("directory"));
    CHECK_THAT(error(folder.path() / "none" / "field.vdb"), Contains("No such file"));
    CHECK_THAT(error("/proc/none.vdb"), Contains("/proc/none.vdb"));
    CHECK_THAT(error("/dev/full"), Contains("/dev/full"));

    SECTION("a disk that fills up") {
        // The limit on the size of files fails writing as a full disk does.
        rlimit before{};
        getrlimit(RLIMIT_FSIZE, &before);
        const auto handler = ::signal(SIGXFSZ, SIG_IGN);
        const rlimit tiny{20000, before.rlim_max};
        setrlimit(RLIMIT_FSIZE, &tiny);
        const std::string message = error(folder.path() / "field.vdb");
        setrlimit(RLIMIT_FSIZE, &before);
        ::signal(SIGXFSZ, handler);
        CHECK_THAT(message, Contains("field.vdb") && Contains("File too large"));
    }
    CHECK(holds_no_file(folder.path()));
}

}  // namespace controlspace::write_vdb_test
