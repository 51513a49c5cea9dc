#include <openvdb/tools/Interpolation.h>

#include <catch2/catch.hpp>

#include "baselines/fixtures.h"
#include "baselines/openvdb/openvdb_value.h"
#include "baselines/openvdb/prune.h"
#include "controlspace/error.h"
#include "controlspace/metric/intersection.h"
#include "controlspace/metric/nonconformity.h"
#include "counting_allocator.h"
#include "editable_space.h"

namespace controlspace {

TEST_CASE("OpenVDB and the uniform grid agree to the bit") {
    const std::string suffix = GENERATE("-nearest", "-trilinear");
    const SpaceOptions options = small_grid();
    const auto uniform = make_structure("uniform" + suffix, options);
    const auto vdb = make_structure("openvdb-uniform" + suffix, options);
    const std::vector<PointSource> sources = random_sources(3000, options);
    CHECK(uniform->insert(sources).inserted == vdb->insert(sources).inserted);

    std::mt19937_64 random(11);
    std::vector<Point> points;
    for (int i = 0; i < 20000; ++i) points.push_back(random_point(random, options.domain));
    CHECK(sample(*uniform, points) == sample(*vdb, points));

    GradationOptions gradation;
    gradation.law = GradationLaw::mean_length;
    CHECK(uniform->grade(gradation).operations == vdb->grade(gradation).operations);
    CHECK(sample(*uniform, points) == sample(*vdb, points));
}

TEST_CASE("the trilinear grids answer as OpenVDB's own BoxSampler does") {
    const SpaceOptions options = small_grid();
    const auto grid = make_structure("openvdb-uniform-trilinear", options);
    grid->insert(random_sources(3000, options));
    const ControlNodes nodes = grid->control_nodes(Neighbourhood::faces);
    const auto& lattice = std::get<Lattice>(nodes.graph);
    VdbMetricTree tree;
    for (NodeIndex n = 0; n < lattice.size(); ++n) {
        const auto [i, j, k] = lattice.coordinates(n);
        tree.setValue(openvdb::Coord(static_cast<int>(i), static_cast<int>(j), static_cast<int>(k)),
                      VdbMetric(nodes.metrics[n]));
    }

    std::mt19937_64 random(13);
    for (int i = 0; i < 5000; ++i) {
        const Point x = random_point(random, options.domain);
        const Vector place = (x - lattice.origin).cwiseQuotient(lattice.spacing);
        const VdbMetric expected = openvdb::tools::BoxSampler::sample(
            tree, openvdb::Vec3R(place.x(), place.y(), place.z()));
        REQUIRE(difference(sample_at(*grid, x), expected.metric) <= 1e-13);
    }
}

TEST_CASE("two Vec3S trees answer as the grid of doubles does, up to the rounding of floats") {
    const SpaceOptions options = small_grid();
    const auto doubles = make_structure("openvdb-uniform-trilinear", options);
    const auto floats = make_structure("openvdb-vec3s-trilinear", options);
    const std::vector<PointSource> sources = random_sources(300, options);
    CHECK(doubles->insert(sources).inserted == floats->insert(sources).inserted);
    doubles->grade({});
    floats->grade({});
    std::mt19937_64 random(19);
    double worst = 0;
    for (int i = 0; i < 5000; ++i) {
        const Point x = random_point(random, options.domain);
        worst = std::max(worst, nonconformity(sample_at(*doubles, x), sample_at(*floats, x)));
    }
    CHECK(worst < structure_with_id("openvdb-vec3s-trilinear").find<MetricNodes>()->rounding);
    CHECK(worst > 0);
    CHECK(2 * floats->footprint().bytes_payload == doubles->footprint().bytes_payload);

    SpaceOptions later = options;
    later.takes_later_sources = true;
    CHECK_THROWS_AS(make_structure("openvdb-vec3s-trilinear", later), InputError);
}

TEST_CASE("two Vec3S trees refuse metrics that floats cannot hold") {
    const auto made = [] { return make_structure("openvdb-vec3s-trilinear", small_grid()); };
    const Point x = made()->domain().centre();
    for (const double length : {1e-46, 1e-39, 1e39}) {
        const Metric thin = metric_from_frame({length, 1, 1}, Eigen::Matrix3d::Identity());
        if (length < 1) {
            for (const Metric& m : {Metric::isotropic(length), thin}) {
                const auto inserted = [&] {
                    const auto space = made();
                    space->insert({x, m});
                    return sample_at(*space, x);
                };
                CHECK_THROWS_WITH(inserted(), Catch::Contains("floats"));
            }
        }
        const auto space = made();
        const std::size_t nodes = space->control_nodes(Neighbourhood::faces).metrics.size();
        const auto assigned = [&] {
            space->assign(std::vector(nodes, Metric::isotropic(length)));
            return sample_at(*space, x);
        };
        CHECK_THROWS_WITH(assigned(), Catch::Contains("floats"));
    }
    const auto space = made();
    CHECK(space->insert({x, Metric::isotropic(1e-30)}) == Insertion::inserted);
    CHECK(sample_at(*space, x).xx == Approx(1e-30));
}

TEST_CASE("the footprint of two Vec3S trees is what they have allocated") {
    const auto made = [] {
        return structure_with_id("openvdb-vec3s-trilinear").make(small_grid())->build();
    };
    made();  // what the libraries allocate at their first use, and keep
    const std::size_t before = live_bytes();
    const auto space = made();
    const std::size_t allocated = live_bytes() - before;
    CHECK(space->footprint().bytes_total() <= allocated);
    CHECK(space->footprint().bytes_total() + 3072 >= allocated);
}

TEST_CASE("pruning never makes a metric larger, nor smaller by more than its tolerance") {
    SpaceOptions options;
    options.domain = {Point(-1, -1, -1), Point(1, 1, 1)};
    options.finest_length = 1.0 / 16;
    options.voxel = 1.0 / 32;
    const std::string id = GENERATE("openvdb-uniform-nearest", "openvdb-uniform-trilinear");
    INFO(id);
    std::vector<PointSource> sources;
    for (int i = 0; i < 12; ++i) {
        sources.push_back({Point(0.9 * std::cos(i), 0.9 * std::sin(i), 0.15 * i - 0.8),
                           Metric::isotropic(options.finest_length * (1 + 0.2 * i))});
    }
    const auto plain = editable(structure_with_id(id).make(options));
    options.prune_delta = 0.2;
    const auto pruned = editable(structure_with_id(id).make(options));
    for (EditableSpace* space : {plain.get(), pruned.get()}) {
        space->insert(sources);
        space->grade({.ratio = 1.05});
    }
    const auto at_nodes = [](const ControlSpace& space) {
        return control_nodes(space, Neighbourhood::faces).value().metrics;
    };
    const std::vector<Metric> before = at_nodes(*plain);
    const std::vector<Metric> after = at_nodes(*pruned);
    REQUIRE(before.size() == after.size());
    std::size_t changed = 0;
    for (std::size_t i = 0; i < before.size(); ++i) {
        changed += before[i] != after[i] ? 1 : 0;
        REQUIRE(is_within(after[i], 1 + 1e-12, before[i]));
        REQUIRE(nonconformity(after[i], before[i]) <= 0.2 * (1 + 1e-9));
    }
    CHECK(changed > 1000);
    CHECK(static_cast<double>(pruned->footprint().bytes_total()) <
          0.9 * static_cast<double>(plain->footprint().bytes_total()));
    std::mt19937_64 random(17);
    std::vector<Point> x(3000);
    for (Point& place : x) place = random_point(random, options.domain);
    const std::vector<Metric> answers = sample(*plain, x);
    const std::vector<Metric> pruned_answers = sample(*pruned, x);
    for (std::size_t i = 0; i < x.size(); ++i) {
        REQUIRE(nonconformity(answers[i], pruned_answers[i]) <= 0.2 * (1 + 1e-9));
    }

    // What was joined can be written again, alike or not.
    pruned->assign(before);
    CHECK(at_nodes(*pruned) == after);
    std::vector<Metric> uneven = before;
    for (std::size_t i = 0; i < uneven.size(); i += 2) uneven[i] = 2 * uneven[i];
    pruned->assign(uneven);
    CHECK(at_nodes(*pruned) == uneven);
}

TEST_CASE("leaves that are alike become tiles of the metric that all of them allow") {
    openvdb::tree::Tree4<VdbMetric, 3, 3, 2>::Type tree(VdbMetric(0));
    const Metric a{0.2, 0.3, 0.25, 0.01, -0.02, 0.03};
    const auto put = [&](const openvdb::Coord& low, const Metric& m) {
        for (int i = 0; i < 64; ++i) {
            tree.setValue(low + openvdb::Coord(i & 3, i >> 2 & 3, i >> 4), VdbMetric(m));
        }
    };
    for (const int x : {0, 4, 8}) put({x, 0, 0}, a);
    // Differ in the last entry alone, and along different directions.
    const Metric b{0.2, 0.3, 0.25, 0.01, -0.02, 0.035};
    const Metric c{0.22, 0.28, 0.25, 0.01, -0.02, 0.03};
    tree.setValue({1, 2, 3}, VdbMetric(b));
    tree.setValue({2, 2, 3}, VdbMetric(c));
    tree.setValue({5, 1, 1}, VdbMetric(0.5 * a));     // far off
    tree.setValueOff({9, 1, 1}, VdbMetric(0.5 * a));  // does not count
    prune_metrics(tree, 0.1);
    CHECK(tree.leafCount() == 1);
    for (const Metric& m : {a, b, c}) {
        const Metric tile = tree.getValue({3, 3, 3}).metric;
        CHECK(is_within(tile, 1 + 1e-12, m));
        CHECK(nonconformity(tile, m) <= 0.1);
    }
    CHECK(tree.isValueOn({3, 3, 3}));
    CHECK(tree.getValue({5, 1, 1}).metric == 0.5 * a);
    CHECK(tree.getValue({9, 1, 1}).metric == a);
}

TEST_CASE("the arithmetic of OpenVDB's values is entry by entry") {
    const VdbMetric a(Metric{1, 2, 3, 4, 5, 6});
    CHECK(VdbMetric(0) + a == a);
    CHECK((a - a) == VdbMetric(0));
    CHECK(-a == VdbMetric(Metric{-1, -2, -3, -4, -5, -6}));
    CHECK(Abs(-a) == a);
    CHECK(a * 2 == a + a);
    CHECK(VdbMetric(Metric{1, 2, 3, 4, 5, 5}) < a);
    CHECK(a > VdbMetric(1));
}

}  // namespace controlspace
