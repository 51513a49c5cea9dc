#include <openvdb/tools/Interpolation.h>
#include <tbb/global_control.h>

#include <catch2/catch.hpp>
#include <map>

#include "baselines/fixtures.h"
#include "baselines/openvdb/openvdb_value.h"
#include "baselines/openvdb/prune.h"
#include "controlspace/error.h"
#include "controlspace/metric/intersection.h"
#include "controlspace/metric/nonconformity.h"
#include "counting_allocator.h"
#include "editable_space.h"

// The laws of grids in levels.

namespace controlspace {
namespace {

constexpr auto both = {"openvdb-levels-nearest", "openvdb-levels-trilinear"};

// Small enough to be graded in a moment; finest voxels are 1 / 64 of the edge of a cube.
SpaceOptions cube() {
    SpaceOptions options;
    options.domain = {Point(-1, -1, -1), Point(1, 1, 1)};
    options.finest_length = 1.0 / 32;
    return options;
}

/// Sizes of all levels; tensors take far longer to grade.
std::vector<PointSource> isotropic_sources(const SpaceOptions& options) {
    std::vector<PointSource> sources;
    for (int i = 0; i < 12; ++i) {
        sources.push_back({Point(0.9 * std::cos(i), 0.9 * std::sin(i), 0.15 * i - 0.8),
                           Metric::isotropic(options.finest_length * (1 + 0.2 * i))});
    }
    return sources;
}

std::vector<Point> random_points(std::size_t n, const Box& box) {
    std::mt19937_64 random(17);
    std::vector<Point> points(n);
    for (Point& x : points) x = random_point(random, box);
    return points;
}

double volume(const Box& box) { return box.edges().prod(); }

/// Metrics of the control nodes by place; places of the lattices differ by 1 / 128 at least.
class NodesByPlace {
public:
    explicit NodesByPlace(const ControlSpace& space) {
        const ControlNodes nodes = control_nodes(space, Neighbourhood::faces).value();
        const auto& graph = std::get<NodeGraph>(nodes.graph);
        for (NodeIndex i = 0; i < graph.size(); ++i) {
            unique_ = metrics_.emplace(key(graph.position(i)), nodes.metrics[i]).second && unique_;
        }
    }
    bool unique() const { return unique_; }
    const Metric& at(const Point& x) const { return metrics_.at(key(x)); }

private:
    using Key = std::array<long, 3>;
    static Key key(const Point& x) {
        Key k;
        for (Axis a = 0; a < 3; ++a) k[static_cast<std::size_t>(a)] = std::lround(x[a] * 4096);
        return k;
    }
    std::map<Key, Metric> metrics_;
    bool unique_ = true;
};

}  // namespace

TEST_CASE("before gradation, a grid in levels answers as the octree does, to the bit") {
    // An octree's leaves halve the cube; voxels that are halves of it too are its leaves, or parts
    // of leaves that no source has touched.
    const SpaceOptions options = cube();
    const std::vector<PointSource> sources = random_sources(400, options);
    const auto octree = editable(tree_named("K_oL").make(options));
    const auto levels = make_structure("openvdb-levels-nearest", options);
    CHECK(octree->insert(sources).inserted == levels->insert(sources).inserted);
    const std::vector<Point> x = random_points(20000, options.domain);
    CHECK(sample(*octree, x) == sample(*levels, x));
    for (const Point& p : x) {
        const Box element = octree->cell_at(p).value();
        if (element.edges().x() < 0.25) CHECK(levels->cell_at(p).value() == element);
    }
}

TEST_CASE("with all voxels as small as the finest, a grid in levels is the uniform grid") {
    SpaceOptions options = cube();
    options.finest_length = 1.0 / 12;
    options.voxel = 1.0 / 12;
    options.voxel_factor = 1e-3;
    const std::vector<PointSource> sources{{Point(0.3, 0.2, 0.1), Metric::isotropic(0.1)},
                                           {Point(-0.7, 0.8, -0.1), Metric::isotropic(0.12)}};
    const auto uniform = editable(structure_with_id("uniform-nearest").make(options));
    const auto levels = make_structure("openvdb-levels-nearest", options);
    for (EditableSpace* space : {uniform.get(), levels.get()}) {
        space->insert(sources);
        space->grade({});
    }
    CHECK(levels->footprint().cells == 24 * 24 * 24);
    const std::vector<Point> x = random_points(2000, options.domain);
    const std::vector<Metric> expected = sample(*uniform, x);
    const std::vector<Metric> answers = sample(*levels, x);
    for (std::size_t i = 0; i < x.size(); ++i) {
        REQUIRE(difference(answers[i], expected[i]) < 1e-12);
    }
}

TEST_CASE("voxels of all levels fill the domain once, whatever its shape") {
    const std::string id = GENERATE(values(both));
    const SpaceOptions options = small_grid();
    const auto space = make_structure(id, options);
    space->insert(random_sources(20, options));
    space->grade({});
    // An element's share of random places is its volume: so the mean of 1 / volume is their number.
    const std::vector<Point> x = random_points(40000, options.domain);
    double elements = 0;
    for (const Point& p : x) {
        const Box element = space->cell_at(p).value();
        REQUIRE(element.contains(p));
        REQUIRE(space->cell_at(element.centre()).value() == element);
        elements += volume(options.domain) / volume(element) / static_cast<double>(x.size());
    }
    CHECK(elements == Approx(static_cast<double>(space->footprint().cells)).epsilon(0.05));
    CHECK(space->footprint().depth > 0);
}

TEST_CASE(
    "nodes are where they should be, each place once, and voxels blend those at their corners") {
    const std::string id = GENERATE(values(both));
    const SpaceOptions options = cube();
    const auto space = make_structure(id, options);
    const bool graded = GENERATE(false, true);
    space->insert(graded ? isotropic_sources(options) : random_sources(100, options));
    if (graded) space->grade({});
    const NodesByPlace nodes(*space);
    CHECK(nodes.unique());
    for (const Point& x : random_points(3000, options.domain)) {
        const Box element = space->cell_at(x).value();
        if (id == "openvdb-levels-nearest") {
            REQUIRE(sample_at(*space, x) == nodes.at(element.centre()));
            continue;
        }
        VdbMetricTree corners;
        for (int i = 0; i < 8; ++i) {
            corners.setValue(openvdb::Coord(i & 1, i >> 1 & 1, i >> 2),
                             VdbMetric(nodes.at(corner(element, i))));
        }
        const Vector t = (x - element.low).cwiseQuotient(element.edges());
        const VdbMetric expected =
            openvdb::tools::BoxSampler::sample(corners, openvdb::Vec3R(t.x(), t.y(), t.z()));
        REQUIRE(difference(sample_at(*space, x), expected.metric) <= 1e-13);
    }
}

TEST_CASE("after gradation no voxel is longer than its factor times the size it holds") {
    const std::string id = GENERATE(values(both));
    SpaceOptions options = cube();
    options.voxel_factor = GENERATE(2.0, 1.0, 0.5);
    const auto space = make_structure(id, options);
    space->insert(isotropic_sources(options));
    space->grade({});
    const double finest = std::min(options.voxel_factor, 1.0) * options.finest_length;
    double longest = 0;
    double largest_allowed = 0;
    for (const Point& x : random_points(3000, options.domain)) {
        const Box element = space->cell_at(x).value();
        if (element.edges().maxCoeff() <= finest) continue;
        for (int i = 0; i < 8; ++i) {
            // Just inside the corner, since a corner belongs to the voxel above it.
            const Point inside =
                element.centre() + (1 - 1e-9) * (corner(element, i) - element.centre());
            const auto lengths = metric_edge_lengths(sample_at(*space, inside), element.edges());
            longest = std::max({longest, lengths[0], lengths[1], lengths[2]});
        }
        largest_allowed = std::max(largest_allowed, element.edges().maxCoeff());
    }
    CHECK(longest <= options.voxel_factor * (1 + 1e-6));
    CHECK(longest > 0.5 * options.voxel_factor);  // not finer than that requests
    CHECK(largest_allowed > 2 * finest);
}

TEST_CASE("threads do not show in a grid in levels") {
    const std::string id = GENERATE(values(both));
    const auto schedule =
        GENERATE(GradationSchedule::sources, GradationSchedule::queue, GradationSchedule::passes);
    const auto neighbourhood = GENERATE(Neighbourhood::faces, Neighbourhood::all);
    SpaceOptions options = cube();
    options.finest_length = 1.0 / 16;
    options.prune_delta = 0.3;
    const auto make = [&] {
        auto space = make_structure(id, options);
        space->insert(isotropic_sources(options));
        space->grade({.schedule = schedule, .neighbourhood = neighbourhood});
        return space;
    };
    const auto many = make();
    const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
    const auto single = make();
    const ControlNodes a = many->control_nodes(neighbourhood);
    const ControlNodes b = single->control_nodes(neighbourhood);
    CHECK(a.metrics == b.metrics);
    CHECK(std::get<NodeGraph>(a.graph).neighbours == std::get<NodeGraph>(b.graph).neighbours);
    CHECK(many->footprint().bytes_total() == single->footprint().bytes_total());
}

TEST_CASE("pruning never makes a metric larger, nor smaller by more than its tolerance") {
    SpaceOptions options = cube();
    options.finest_length = 1.0 / 16;
    options.voxel = 1.0 / 32;
    options.voxel_factor = 0.5;
    const std::string id = GENERATE("openvdb-uniform-nearest", "openvdb-uniform-trilinear",
                                    "openvdb-levels-nearest", "openvdb-levels-trilinear");
    INFO(id);
    const auto plain = editable(structure_with_id(id).make(options));
    options.prune_delta = 0.2;
    const auto pruned = editable(structure_with_id(id).make(options));
    for (EditableSpace* space : {plain.get(), pruned.get()}) {
        space->insert(isotropic_sources(options));
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
    const std::vector<Point> x = random_points(3000, options.domain);
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
    for (const int x : {0, 4, 8, 12, 16}) put({x, 0, 0}, a);
    // Differ in the last entry alone, and along different directions.
    const Metric b{0.2, 0.3, 0.25, 0.01, -0.02, 0.035};
    const Metric c{0.22, 0.28, 0.25, 0.01, -0.02, 0.03};
    tree.setValue({1, 2, 3}, VdbMetric(b));
    tree.setValue({2, 2, 3}, VdbMetric(c));
    tree.setValue({5, 1, 1}, VdbMetric(0.5 * a));  // far off
    tree.setValueOff({9, 1, 1});                   // holds something, though it is inactive
    for (int i = 0; i < 64; ++i) {
        tree.setValueOff(openvdb::Coord(12 + (i & 3), i >> 2 & 3, i >> 4), VdbMetric(0));
    }
    tree.setValueOff({17, 1, 1}, VdbMetric(0));
    auto loose = tree;
    prune_metrics(tree, {.delta = 0.1});
    CHECK(tree.leafCount() == 3);
    for (const Metric& m : {a, b, c}) {
        const Metric tile = tree.getValue({3, 3, 3}).metric;
        CHECK(is_within(tile, 1 + 1e-12, m));
        CHECK(nonconformity(tile, m) <= 0.1);
    }
    CHECK(tree.isValueOn({3, 3, 3}));
    CHECK(tree.getValue({5, 1, 1}).metric == 0.5 * a);
    CHECK_FALSE(tree.isValueOn({12, 0, 0}));
    CHECK(tree.getValue({12, 0, 0}) == VdbMetric(0));
    CHECK(tree.probeConstLeaf({8, 0, 0}) != nullptr);
    prune_metrics(loose, {.delta = 0.1, .inactive_count = false});
    CHECK(loose.leafCount() == 1);
    CHECK(loose.getValue({17, 1, 1}).metric == a);
}

TEST_CASE("the footprint of a grid in levels is what it has allocated") {
    const std::string id = GENERATE(values(both));
    SpaceOptions options = cube();
    options.prune_delta = GENERATE(0.0, 0.3);
    const std::size_t before = live_bytes();
    const auto space = make_structure(id, options);
    space->insert(isotropic_sources(options));
    space->grade({});
    const std::size_t allocated = live_bytes() - before;
    const Footprint footprint = space->footprint();
    CAPTURE(allocated, footprint.bytes_total(), footprint.cells, footprint.control_nodes);
    // OpenVDB's count leaves out some bytes of each inner node and the tables of roots.
    CHECK(footprint.bytes_total() <= allocated);
    CHECK(static_cast<double>(allocated) <=
          1.01 * static_cast<double>(footprint.bytes_total()) + 2048);
}

TEST_CASE("a grid in levels stays below the memory cap, or says that it cannot") {
    const std::string id = GENERATE(values(both));
    SpaceOptions options = cube();
    options.finest_length = 1.0 / 128;
    options.max_bytes = GENERATE(as<std::size_t>(), 2'000'000, 5'000'000, 10'000'000, 100'000'000);
    const auto neighbourhood = GENERATE(Neighbourhood::faces, Neighbourhood::all);
    const std::size_t before = live_bytes();
    reset_peak_bytes();
    bool refused = false;
    try {
        const auto space = make_structure(id, options);
        space->insert(isotropic_sources(options));
        space->grade({.neighbourhood = neighbourhood});
    } catch (const InputError& error) {
        refused = true;
        CHECK_THAT(error.what(), Catch::Contains("voxel_factor"));
    }
    CAPTURE(peak_bytes() - before, options.max_bytes);
    CHECK(peak_bytes() - before <= options.max_bytes);
    if (options.max_bytes == 2'000'000) CHECK(refused);
    if (options.max_bytes == 100'000'000) CHECK_FALSE(refused);
}

TEST_CASE("levels that no number can hold are refused") {
    SpaceOptions options = cube();
    options.voxel = 1e-12;
    CHECK_THROWS_WITH(make_structure("openvdb-levels-nearest", options),
                      Catch::Contains("raise voxel"));
    options.voxel = 10;  // larger than the domain: one voxel
    CHECK(make_structure("openvdb-levels-nearest", options)->footprint().cells == 1);
}

}  // namespace controlspace
