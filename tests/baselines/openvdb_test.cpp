// SPDX-License-Identifier: Apache-2.0
#include <catch2/catch.hpp>

#include "baselines/fixtures.h"
#include "controlspace/error.h"
#include "controlspace/metric/intersection.h"
#include "controlspace/metric/nonconformity.h"
#include "counting_allocator.h"
#include "editable_space.h"

namespace controlspace::openvdb_test {

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

}  // namespace controlspace::openvdb_test
