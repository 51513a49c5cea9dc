// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <limits>

#include "controlspace/io/read_vdb.h"
#include "export/fixtures.h"
#include "export/made_grids.h"
#include "fields/values.h"

namespace controlspace::read_foreign_vdb_field_test {

using Catch::Matchers::Contains;
namespace fs = std::filesystem;

TEST_CASE("a grid of lengths of somebody else's, under any linear transform") {
    const ScratchDirectory folder;
    const auto grid = lengths("size", 0.25F);
    grid->tree().setValueOn({3, 3, 3}, 0.75F);
    grid->transform().preRotate(0.5, openvdb::math::Z_AXIS);
    grid->transform().postTranslate({10, 20, 30});
    const AnalyticField read = read_vdb_field(write_grids(folder, {grid}), {.grid = "size"});
    CHECK(read.finest_length == 0.25);
    const auto world = [&](double i, double j, double k) {
        const openvdb::Vec3d x = grid->indexToWorld(openvdb::Vec3d(i, j, k));
        return Point(x.x(), x.y(), x.z());
    };
    CHECK(value_at(*read.field, world(1, 2, 0)).xx == Approx(0.25));
    CHECK(value_at(*read.field, world(3, 3, 3)).xx == Approx(0.75));
    CHECK(value_at(*read.field, world(2.5, 3, 3)).xx == Approx(0.5));
    CHECK(value_at(*read.field, world(9, 9, 9)).xx == Approx(0.75));
    CHECK(read.field->domain().contains(world(3.4, 3.4, 3.4)));
}

TEST_CASE("voxels that are not active do not count") {
    const ScratchDirectory folder;
    const auto grid = lengths("size", 0.25F);
    grid->tree().setValueOn({0, 0, 0}, 0.5F);
    grid->tree().setValueOff({3, 3, 3}, 99);
    grid->tree().setValueOn({20, 20, 20}, 0.25F);
    const auto field = read_vdb_field(write_grids(folder, {grid}), {.grid = "size"}).field;
    CHECK(value_at(*field, Point(1.25, 1.5, 1.5)).xx == Approx(0.25));
    // None around: the coarsest of the file.
    CHECK(value_at(*field, Point(5, 5, 5)).xx == Approx(0.5));
}

TEST_CASE("a painted density drives lengths") {
    const ScratchDirectory folder;
    const auto grid = lengths("paint", 0.5F);
    grid->tree().setValueOn({0, 0, 0}, 1.0F);
    grid->tree().setValueOn({3, 3, 3}, 0.0F);
    grid->tree().setValueOn({40, 40, 40}, 5.0F);
    const VdbLengths options{.grid = "paint", .density = DensitySizes{0.01, 1}};
    const AnalyticField read = read_vdb_field(write_grids(folder, {grid}), options);
    CHECK(value_at(*read.field, {0, 0, 0}).xx == Approx(0.01));
    CHECK(value_at(*read.field, {0.5, 0.5, 0.5}).xx == Approx(0.1));
    CHECK(value_at(*read.field, {1.5, 1.5, 1.5}).xx == Approx(1));
    CHECK(value_at(*read.field, {8, 8, 8}).xx == Approx(1));
    CHECK(value_at(*read.field, {20, 20, 20}).xx == Approx(0.01));
    CHECK(read.finest_length == Approx(0.01));
}

TEST_CASE("files that cannot be used are refused in one line") {
    const ScratchDirectory folder;
    const auto error = [&](const fs::path& path, const VdbLengths& options) {
        return error_of([&] { read_vdb_field(path, options); });
    };
    const auto foreign = [&](const openvdb::GridCPtrVec& grids, const VdbLengths& options) {
        return error(write_grids(folder, grids), options);
    };
    const openvdb::Vec3s one(1);
    const openvdb::Vec3s zero(0);

    CHECK_THAT(error(folder.path() / "none.vdb", {}), Contains("none.vdb") && Contains("No such"));
    CHECK_THAT(error(folder.path(), {}), Contains("directory"));
    CHECK_THAT(error(folder.file("text.vdb", "no grids here, but text of some length"), {}),
               Contains("text.vdb") && Contains("no .vdb file"));
    CHECK_THAT(error(folder.file("empty.vdb", ""), {}), Contains("no .vdb file"));
    CHECK_THAT(foreign({}, {}), Contains("holds no grid"));

    CHECK_THAT(foreign({lengths("a", 1), lengths("b", 1)}, {.grid = "c"}),
               Contains("no grid 'c'") && Contains("a (float), b (float)"));
    CHECK_THAT(foreign({lengths("a", 1)}, {}), Contains("metric_diag") && Contains("a (float)"));
    CHECK_THAT(foreign({tensors("metric_diag", one)}, {}), Contains("no grid 'metric_off'"));
    CHECK_THAT(foreign({tensors("a", one)}, {.grid = "a"}), Contains("not of type float"));
    CHECK_THAT(foreign({lengths("a", 1)}, {.density = DensitySizes{1, 2}}), Contains("name the"));
    CHECK_THAT(foreign({lengths("a", 1)}, {.grid = "a", .density = DensitySizes{0, 2}}),
               Contains("positive"));

    CHECK_THAT(foreign({lengths("a", std::nanf(""))}, {.grid = "a"}),
               Contains("nan") && Contains("voxel (0, 0, 0)"));
    CHECK_THAT(foreign({lengths("a", 0)}, {.grid = "a"}), Contains("must be positive"));
    CHECK_THAT(foreign({lengths("a", -1)}, {.grid = "a"}), Contains("must be positive"));
    CHECK_THAT(foreign({lengths("a", std::numeric_limits<float>::infinity())}, {.grid = "a"}),
               Contains("inf"));
    CHECK_THAT(foreign({no_lengths("a")}, {.grid = "a"}), Contains("'a' is empty"));

    const auto bent = lengths("a", 1);
    bent->setTransform(openvdb::math::Transform::createFrustumTransform(
        openvdb::BBoxd({0, 0, 0}, {3, 3, 3}), 0.5, 10, 1));
    CHECK_THAT(foreign({bent}, {.grid = "a"}), Contains("not linear"));

    const auto mapped = [&](const openvdb::math::MapBase::Ptr& map) {
        const auto grid = lengths("a", 1);
        grid->setTransform(openvdb::math::Transform::Ptr(new openvdb::math::Transform(map)));
        return foreign({grid}, {.grid = "a"});
    };
    const auto scaled = [&](double by) {
        return mapped(std::make_shared<openvdb::math::UniformScaleMap>(by));
    };
    const auto moved = [&](double by) {
        return mapped(std::make_shared<openvdb::math::TranslationMap>(openvdb::Vec3d(by, 0, 0)));
    };
    CHECK(scaled(1e9).empty());
    CHECK(moved(-1e6).empty());
    CHECK_THAT(scaled(1e60), Contains("where nothing can be computed"));
    CHECK_THAT(scaled(1e200), Contains("voxels have the volume inf"));
    CHECK_THAT(moved(std::nan("")), Contains("voxels have the volume nan"));
    const auto named = lengths("two\nlines", 1);
    CHECK(error_of([&] {
              read_vdb_field(write_grids(folder, {named}), {.grid = "one"});
          }).find('\n') == std::string::npos);

    CHECK_THAT(
        foreign({tensors("metric_diag", one), tensors("metric_off", openvdb::Vec3s(0, 2, 0))}, {}),
        Contains("not positive definite"));
    CHECK_THAT(foreign({tensors("metric_diag", openvdb::Vec3s(1, std::nanf(""), 1)),
                        tensors("metric_off", zero)},
                       {}),
               Contains("not positive definite"));
    const auto shifted = tensors("metric_off", zero);
    shifted->transform().postTranslate({1, 0, 0});
    CHECK_THAT(foreign({tensors("metric_diag", one), shifted}, {}),
               Contains("different transforms"));
}

}  // namespace controlspace::read_foreign_vdb_field_test
