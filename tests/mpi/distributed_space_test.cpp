// SPDX-License-Identifier: Apache-2.0
// To be run by mpirun with some ranks: all of them run all tests. Nothing may end a test early on
// one rank alone (REQUIRE), or the others would wait for it.
#define OMPI_SKIP_MPICXX 1
#define MPICH_SKIP_MPICXX 1
#include "mpi/distributed_space.h"

#include <Eigen/LU>
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdlib>
#include <string>
#include <vector>

#include "controlspace/error.h"
#include "controlspace/measure/access_time.h"
#include "controlspace/measure/reference.h"
#include "controlspace/metric/intersection.h"
#include "controlspace/metric/metric.h"
#include "controlspace/metric/nonconformity.h"
#include "controlspace/sources/cone.h"
#include "controlspace/space/make_control_space.h"
#include "geometry/random_fractions.h"

namespace controlspace::distributed_space_test {
namespace {

constexpr std::size_t places = 5000;
constexpr std::uint64_t seed = 7;

struct World {
    World() {
        int started = 0;
        MPI_Initialized(&started);
        if (!started) {
            MPI_Init(nullptr, nullptr);
            std::atexit([] { MPI_Finalize(); });
        }
        MPI_Comm_rank(MPI_COMM_WORLD, &rank);
        MPI_Comm_size(MPI_COMM_WORLD, &size);
    }
    int rank = 0, size = 1;
};

/// What rank 0 has.
template <class T>
void broadcast(std::vector<T>& values) {
    MPI_Bcast(values.data(), static_cast<int>(values.size() * sizeof(T)), MPI_BYTE, 0,
              MPI_COMM_WORLD);
}

struct Scene {
    std::string name;
    Box domain;
    std::vector<PointSource> sources;
    double h_max = largest_magnitude;
};

PointSource at(const Point& x, double h, double growth = 0) {
    return {x, Metric::isotropic(h), growth};
}

// Places, lengths and growths in any order: dense, sparse, coarse among fine, outside of the
// middle.
std::vector<Scene> scenes() {
    RandomFractions fraction(3);
    const auto in = [&](const Box& box) {
        Point x;
        for (Axis a = 0; a < 3; ++a) x[a] = box.low[a] + fraction() * (box.high[a] - box.low[a]);
        return x;
    };
    const Box cube{Point::Constant(-1), Point::Constant(1)};
    std::vector<Scene> all;
    Scene sphere{"sphere", cube, {}};
    for (int i = 0; i < 1200; ++i) {
        const Vector v = in(cube);
        const Point x = 0.8 * v.normalized();
        sphere.sources.push_back(at(x, 0.03 + 0.02 * x.z()));
    }
    all.push_back(sphere);
    Scene mixed{"lengths from 0.001 to 0.5", {Point(1, 2, 3), Point(3, 4, 5)}, {}};
    for (int i = 0; i < 800; ++i) {
        mixed.sources.push_back(at(in(mixed.domain), 0.001 * std::pow(500.0, fraction())));
    }
    all.push_back(mixed);
    Scene steep = sphere;
    steep.name = "growths of their own";
    for (std::size_t i = 0; i < steep.sources.size(); i += 3) {
        steep.sources[i].growth = 1 + 2 * fraction();
    }
    all.push_back(steep);
    Scene oblong{"oblong", {Point(-4, 0, 10), Point(4, 2, 11)}, {}};
    for (int i = 0; i < 800; ++i) {
        Point x = in(oblong.domain);
        x.y() = 1 + 0.3 * std::sin(x.x());
        oblong.sources.push_back(at(x, 0.05));
    }
    all.push_back(oblong);
    Scene flat{"flat", {Point(0, 0, 0), Point(2, 1, 0)}, {}};
    for (int i = 0; i < 600; ++i) {
        flat.sources.push_back(at(Point(fraction() * 2, 0.5, 0), 0.004 + 0.01 * fraction()));
    }
    all.push_back(flat);
    Scene bounded = sphere;
    bounded.name = "h_max";
    bounded.h_max = 0.1;
    all.push_back(bounded);
    all.push_back({"one source", cube, {at(Point(0.3, 0.2, 0.1), 0.01)}});
    // On the planes between octants, many at one place, and some dominated.
    Scene lattice{"lattice", cube, {}};
    for (int i = 0; i < 800; ++i) {
        const auto step = [&] { return -1 + std::floor(fraction() * 33) / 16; };
        lattice.sources.push_back(at(Point(step(), step(), step()), i % 5 == 0 ? 0.01 : 0.125));
    }
    all.push_back(lattice);
    // Fine leaves beside large octants without sources, which are cut for them to be balanced.
    Scene clusters{"clusters", cube, {}};
    for (int k = 0; k < 60; ++k) {
        const Point centre = 0.95 * in(cube);
        for (int i = 0; i < 12; ++i) {
            const double h = i == 0 ? 1e-4 : 0.005;
            clusters.sources.push_back(at(centre + 0.03 * in(cube), h));
        }
    }
    all.push_back(clusters);
    return all;
}

std::vector<PointSource> share(const std::vector<PointSource>& all, int begin, int end, int of) {
    const auto border = [&](int r) {
        return all.begin() + static_cast<std::ptrdiff_t>(all.size()) * r / of;
    };
    return {border(begin), border(end)};
}

DistributedOptions options_for(const Scene& scene) {
    DistributedOptions options;
    options.space.domain = scene.domain;
    options.space.h_max = scene.h_max;
    return options;
}

std::unique_ptr<ControlSpace> serial(const Scene& scene, const DistributedOptions& options) {
    return make_control_space(options.structure, scene.sources, options.space, options.target);
}

std::uint64_t checksum_of(const ControlSpace& space) {
    const std::vector<Point> x = random_points(space.domain(), places, seed);
    std::vector<Metric> answers(x.size());
    space.sample(x, answers);
    return checksum(answers);
}

void check_equal(const Scene& scene, const DistributedOptions& options) {
    const World world;
    CAPTURE(scene.name, options.structure, options.target.value_or(0), world.rank);
    std::uint64_t expected = world.rank == 0 ? checksum_of(*serial(scene, options)) : 0;
    MPI_Bcast(&expected, 1, MPI_UINT64_T, 0, MPI_COMM_WORLD);
    const DistributedSpace even(
        MPI_COMM_WORLD, share(scene.sources, world.rank, world.rank + 1, world.size), options);
    CHECK(even.checksum(places, seed) == expected);
    // All sources on the last rank.
    const bool has_all = world.rank == world.size - 1;
    const DistributedSpace uneven(MPI_COMM_WORLD,
                                  has_all ? scene.sources : std::vector<PointSource>(), options);
    CHECK(uneven.checksum(places, seed) == expected);
}

PointSource layer_at(const Point& x, const Vector& normal, double across, double along) {
    return {x, layer_metric(normal, across, along), 0};
}

// Layers on a sphere, directions and lengths at random, tensors beside lengths.
std::vector<Scene> scenes_of_tensors() {
    RandomFractions fraction(5);
    const Box cube{Point::Constant(-1), Point::Constant(1)};
    const auto direction = [&] {
        const auto along = [&] { return 2 * fraction() - 1; };
        return Vector(along(), along(), along()).normalized();
    };
    const Box upper{Point(-1, -1, 0.9), Point(1, 1, 2.9)};
    std::vector<Scene> all;
    Scene sphere{"layers on a sphere", cube, {}};
    for (int i = 0; i < 900; ++i) {
        const Vector n = direction();
        sphere.sources.push_back(layer_at(0.7 * n, n, 0.012, 0.06));
    }
    all.push_back(sphere);
    Scene thin{"thin layers, growths of their own", upper, {}};
    for (int i = 0; i < 500; ++i) {
        const Vector n = direction();
        thin.sources.push_back(layer_at(Point(0, 0, 1.9) + 0.5 * n, n, 0.003, 0.12));
        if (i % 4 == 0) thin.sources.back().growth = 1 + fraction();
    }
    all.push_back(thin);
    Scene mixed{"some tensors among lengths", cube, {}};
    for (int i = 0; i < 600; ++i) {
        const Vector n = direction();
        const Point x = 0.9 * std::cbrt(fraction()) * direction();
        mixed.sources.push_back(i % 10 == 0 ? layer_at(x, n, 0.02, 0.2)
                                            : at(x, 0.05 * std::pow(8.0, fraction())));
    }
    all.push_back(mixed);
    return all;
}

double log_of_determinant(const Metric& m) { return std::log(m.matrix().determinant()); }

// That a metric is no longer than any cone at x, nor M_max.
bool is_within_cones(const Metric& m, const Point& x, const Scene& scene,
                     const SpaceOptions& space) {
    constexpr double safely = 1 + 1e-6;
    return is_within(m, safely, largest_metric(space)) &&
           std::ranges::all_of(scene.sources, [&](const PointSource& s) {
               return is_within(m, safely * cone_factor(s, space.ratio, x), s.metric);
           });
}

}  // namespace

TEST_CASE("ranks answer as one does: inserted and graded") {
    for (const Scene& scene : scenes()) {
        DistributedOptions options = options_for(scene);
        for (const char* structure : {"K_oL", "K_oV", "K_oLB"}) {
            options.structure = structure;
            check_equal(scene, options);
        }
    }
    Scene mixed = scenes()[1];
    DistributedOptions coarse = options_for(mixed);
    coarse.space.l_min = 4;  // leaves inherit metrics that the field does not replace
    coarse.space.ratio = 2;
    check_equal(mixed, coarse);
    DistributedOptions shallow = options_for(mixed);
    shallow.space.octree_depth = 4;
    check_equal(mixed, shallow);
}

TEST_CASE("ranks answer as one does: adapted") {
    for (const Scene& scene : scenes()) {
        DistributedOptions options = options_for(scene);
        options.target = 0.4;
        for (const char* structure : {"K_oL", "K_oV", "K_oLB"}) {
            options.structure = structure;
            check_equal(scene, options);
        }
    }
}

TEST_CASE("tensors, inserted and graded: metrics are within all cones, and as large as one's") {
    const World world;
    auto scenes = scenes_of_tensors();
    const std::string structure = GENERATE("K_oL", "K_oV", "K_oLB");
    if (structure == "K_oLB") scenes.resize(1);  // ranks make most of the tree, which takes long
    for (const Scene& scene : scenes) {
        DistributedOptions options = options_for(scene);
        options.structure = structure;
        CAPTURE(scene.name, structure, world.rank);
        const DistributedSpace space(
            MPI_COMM_WORLD, share(scene.sources, world.rank, world.rank + 1, world.size), options);
        CHECK(space.report().has_tensors);
        // Control nodes, in the leaf that answers there: its centre, or its highest corner.
        std::vector<Point> x(1000);
        std::vector<Box> leaves(x.size());
        std::vector<Metric> found(x.size()), expected(x.size());
        if (world.rank == 0) {
            const auto whole = serial(scene, options);
            x = random_points(scene.domain, x.size(), seed);
            for (std::size_t i = 0; i < x.size(); ++i) {
                leaves[i] = *whole->cell_at(x[i]);
                x[i] = structure == "K_oV" ? leaves[i].high : leaves[i].centre();
            }
            whole->sample(x, expected);
        }
        broadcast(x);
        broadcast(leaves);
        broadcast(expected);
        space.sample(x, found);
        const double tolerance = 3 * std::log(1.01) + 1e-6;
        std::size_t beyond = 0, smaller = 0, of_other_leaves = 0;
        for (std::size_t i = 0; i < x.size(); ++i) {
            beyond += is_within_cones(found[i], x[i], scene, options.space) ? 0u : 1u;
            const double ratio = log_of_determinant(found[i]) - log_of_determinant(expected[i]);
            smaller += std::abs(ratio) <= tolerance ? 0u : 1u;
            const bool is_own = space.owner_of(x[i]) == world.rank;
            of_other_leaves += is_own && *space.own().cell_at(x[i]) != leaves[i];
        }
        CHECK(beyond == 0);
        CHECK(smaller == 0);
        CHECK(of_other_leaves == 0);
    }
}

TEST_CASE("tensors, adapted: the target is kept") {
    const World world;
    const Scene scene = scenes_of_tensors()[0];
    const std::vector<Point> x = random_points(scene.domain, places, seed);
    std::vector<Metric> expected(x.size()), found(x.size());
    if (world.rank == 0) {
        exact_reference(scene.sources, SpaceOptions().ratio, largest_metric(scene.domain), 1e-3)
            ->sample(x, expected);
    }
    broadcast(expected);
    for (const char* structure : {"K_oL", "K_oV", "K_oLB"}) {
        DistributedOptions options = options_for(scene);
        options.structure = structure;
        options.target = 0.5;
        CAPTURE(structure, world.rank);
        const DistributedSpace space(
            MPI_COMM_WORLD, share(scene.sources, world.rank, world.rank + 1, world.size), options);
        CHECK(space.report().met);
        space.sample(x, found);
        double worst = 0;
        for (std::size_t i = 0; i < x.size(); ++i) {
            worst = std::max(worst, nonconformity(found[i], expected[i]));
        }
        CHECK(worst < 1.1 * *options.target);
    }
}

TEST_CASE("the number of octants does not change an answer") {
    const Scene scene = scenes()[1];
    for (const std::uint64_t octants : {1, 8, 1000}) {
        DistributedOptions options = options_for(scene);
        options.octants_per_rank = octants;
        check_equal(scene, options);
        if (octants == 8) {
            for (const char* structure : {"K_oV", "K_oLB"}) {
                options.structure = structure;
                check_equal(scene, options);
            }
        }
        options.target = 0.5;
        for (const char* structure : {"K_oL", "K_oLB"}) {
            options.structure = structure;
            check_equal(scene, options);
        }
    }
}

TEST_CASE("ranks share octants and sources out") {
    const World world;
    const Scene scene = scenes()[0];
    const DistributedSpace space(MPI_COMM_WORLD,
                                 share(scene.sources, world.rank, world.rank + 1, world.size),
                                 options_for(scene));
    const RankReport report = space.report();
    CHECK(report.octants_of_all > 64);
    CHECK(report.octants == space.octants().size());
    const double own = static_cast<double>(report.owned);
    const double mean = static_cast<double>(scene.sources.size()) / world.size;
    CHECK(own > 0.5 * mean);
    CHECK(own < 1.6 * mean);
    // A rank gets a part of the others' sources alone.
    if (world.size > 1) CHECK(report.received < scene.sources.size() / 2);
    CHECK(report.octants_of_all < 2000 * static_cast<std::uint64_t>(world.size));
    if (world.size == 1) CHECK(report.bytes_sent == 0);
    for (const Box& box : space.octants()) CHECK(space.owner_of(box.centre()) == world.rank);
}

TEST_CASE("a rank gets the field of a box of its own") {
    const World world;
    for (const std::string structure :
         {"K_oL", "K_oL, adapted", "K_oV", "K_oLB", "K_oLB, adapted"}) {
        const Scene scene = scenes()[1];
        DistributedOptions options = options_for(scene);
        options.structure = structure.substr(0, structure.find(','));
        if (structure.ends_with("adapted")) options.target = 0.4;
        const auto whole = serial(scene, options);
        const DistributedSpace space(
            MPI_COMM_WORLD, share(scene.sources, world.rank, world.rank + 1, world.size), options);
        const Point low(1.2 + 0.2 * world.rank, 2.3, 3.4);
        const Box box{low, low + Vector(0.5, 0.6, 0.7)};
        const auto field = space.field_for(box);
        const std::vector<Point> x = random_points(box, places, seed);
        std::vector<Metric> found(x.size()), expected(x.size());
        field->sample(x, found);
        whole->sample(x, expected);
        CHECK(found == expected);
    }
}

TEST_CASE("places anywhere are answered by their owners") {
    const World world;
    const Scene scene = scenes()[3];
    const DistributedOptions options = options_for(scene);
    const auto whole = serial(scene, options);
    const DistributedSpace space(
        MPI_COMM_WORLD, share(scene.sources, world.rank, world.rank + 1, world.size), options);
    // Some outside; another number on each rank, none on the first.
    const Box around{scene.domain.low - Vector::Ones(), scene.domain.high + Vector::Ones()};
    const auto n = static_cast<std::size_t>(1000 * world.rank);
    const std::vector<Point> x = random_points(around, n, seed);
    std::vector<Metric> found(n), expected(n);
    space.sample(x, found);
    whole->sample(x, expected);
    CHECK(found == expected);
}

TEST_CASE("what fails on one rank is thrown on all") {
    const World world;
    const Scene scene = scenes()[0];
    const auto own = share(scene.sources, world.rank, world.rank + 1, world.size);
    const auto message = [&](const std::vector<PointSource>& sources,
                             const DistributedOptions& options) -> std::string {
        try {
            const DistributedSpace space(MPI_COMM_WORLD, sources, options);
        } catch (const InputError& error) {
            return error.what();
        }
        return "";
    };
    auto bad = own;
    if (world.rank == world.size - 1) bad.back().position.x() = 5;
    const std::string last = std::to_string(scene.sources.size() - 1);
    using Catch::Contains;
    CHECK_THAT(message(bad, options_for(scene)), Contains("source " + last));
    bad = own;
    if (world.rank == world.size - 1) bad.back().metric = {1, 2, 3, 0, 0, 0};
    DistributedOptions in_turn = options_for(scene);
    in_turn.space.intersection = IntersectionRule::in_turn;
    CHECK_THAT(message(bad, in_turn), Contains("tensors") && Contains("in-turn"));
    if (world.rank == world.size - 1) bad.back().metric = {1e-9, 1, 1, 0, 0, 0};
    CHECK_THAT(message(bad, options_for(scene)), Contains("source " + last));
    for (const char* structure : {"K_oLi", "K_L", "K_oLA"}) {
        DistributedOptions options = options_for(scene);
        options.structure = structure;
        options.target = 0.2;
        CHECK_THAT(message(own, options), Contains(structure) && Contains("give K_oL"));
    }
    DistributedOptions small = options_for(scene);
    small.space.max_bytes = 1000;
    CHECK_THAT(message(own, small), Contains("memory"));
    // The ranks go on together.
    check_equal(scene, options_for(scene));
}

}  // namespace controlspace::distributed_space_test
