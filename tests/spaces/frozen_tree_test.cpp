// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <functional>
#include <initializer_list>
#include <limits>
#include <tuple>
#include <utility>
#include <vector>

#include "case_of_each.h"
#include "controlspace/error.h"
#include "controlspace/measure/access_time.h"
#include "controlspace/metric/nonconformity.h"
#include "controlspace/sources/sampled_surfaces.h"
#include "controlspace/space/catalogue.h"
#include "controlspace/space/split_words.h"
#include "counting_allocator.h"
#include "editable_space.h"
#include "geometry/random_fractions.h"

namespace controlspace::frozen_tree_test {

using Catch::Matchers::Contains;

namespace {

const Box domain{Point(-1, -1, -1), Point(1, 1.5, 1)};

struct TreeUnderTest {
    const CatalogueEntry* entry;
    SplitRule split;

    std::unique_ptr<EditableSpace> graded(const std::vector<PointSource>& sources) const {
        auto space = editable(entry->make({.domain = domain, .split = split}));
        space->insert(sources);
        space->grade({});
        return space;
    }
};

std::string case_name(const TreeUnderTest& tree) {
    return tree.entry->id + ", " + std::string(name_of(tree.split));
}

std::vector<TreeUnderTest> trees() {
    std::vector<TreeUnderTest> all;
    for (const CatalogueEntry& entry : tree_catalogue()) {
        all.push_back({&entry, SplitRule::middle});
        if (!entry.has<SplitRules>()) continue;
        all.push_back({&entry, SplitRule::golden});
        all.push_back({&entry, SplitRule::metric});
    }
    return all;
}

std::vector<PointSource> sphere(double s_n, double h = 0.14) {
    return sample_sphere({.h = h, .s_a = 3, .s_n = s_n, .rho = 1});
}

// Random places, places on planes of cuts, and places outside.
std::vector<Point> places() {
    std::vector<Point> x = random_points({Point(-1.1, -1.1, -1.1), Point(1.1, 1.7, 1.1)}, 1500, 7);
    RandomFractions fraction(8);
    const auto step = [&](Axis a) {
        return domain.low[a] + std::floor(65 * fraction()) / 64 * (domain.high[a] - domain.low[a]);
    };
    for (int i = 0; i < 1500; ++i) x.emplace_back(step(0), step(1), step(2));
    return x;
}

}  // namespace

CASE_OF_EACH(tree, trees(),
             "frozen with doubles, a tree answers the same bits, with floats to 1e-6") {
    const std::vector<Point> x = places();
    for (const double s_n : {1.0, 0.2}) {
        const std::vector<PointSource> sources = sphere(s_n);
        CAPTURE(s_n);
        const auto space = tree.graded(sources);
        const auto doubles = space->compact(Precision::doubles);
        const auto floats = space->compact(Precision::floats);
        const std::vector<Metric> expected = answers(*space, x);
        CHECK(checksum(answers(*doubles, x)) == checksum(expected));
        if (s_n == 1) {
            const auto log16 = space->compact(Precision::log16);
            const auto log8 = space->compact(Precision::log8);
            for (const ControlSpace* form : std::initializer_list<const ControlSpace*>{
                     &space->built(), doubles.get(), floats.get(), log16.get(), log8.get()}) {
                std::vector<double> lengths(x.size());
                form->sample_lengths(x, lengths);
                const std::vector<Metric> metrics = answers(*form, x);
                for (std::size_t i = 0; i < x.size(); ++i) {
                    REQUIRE(lengths[i] == metrics[i].xx);
                    REQUIRE(lengths[i] == form->length_at(x[i]));
                }
            }
        }
        double most = 0;
        const std::vector<Metric> rounded = answers(*floats, x);
        for (std::size_t i = 0; i < x.size(); ++i) {
            const double length = mean_length(expected[i]);
            const auto apart = [&](double a, double b) { return std::abs(a - b) / length; };
            const Metric& a = rounded[i];
            const Metric& b = expected[i];
            most = std::max({most, apart(a.xx, b.xx), apart(a.yy, b.yy), apart(a.zz, b.zz),
                             apart(a.xy, b.xy), apart(a.xz, b.xz), apart(a.yz, b.yz)});
            REQUIRE(space->built().metric_at(x[i]) == expected[i]);
            REQUIRE(doubles->metric_at(x[i]) == expected[i]);
            REQUIRE(floats->metric_at(x[i]) == rounded[i]);
            REQUIRE(doubles->cell_at(x[i]).value() == space->cell_at(x[i]).value());
            REQUIRE(floats->cell_at(x[i]).value() == space->cell_at(x[i]).value());
        }
        CHECK(most > 0);
        // A metric is rounded by 6e-8; the quadratic's weights reach beyond 1.
        CHECK(most < 5e-7);
        CHECK(floats->domain() == domain);
    }
}

CASE_OF_EACH(entry, tree_catalogue(), "codes round lengths by half a step at a million places",
             "[long]") {
    const auto space = TreeUnderTest{&entry, SplitRule::middle}.graded(sphere(1));
    const bool interpolates = entry.order < 2;  // with weights from 0 to 1
    if (interpolates) {
        std::vector<Metric> lengths = space->control_nodes(Neighbourhood::faces).metrics;
        RandomFractions fraction(5);
        for (Metric& m : lengths) m = Metric::isotropic(1e-3 * std::pow(4.9e5, fraction()));
        space->assign(lengths);
    }
    const auto nodes = space->control_nodes(Neighbourhood::faces).metrics;
    const auto [shortest, longest] = std::ranges::minmax(nodes, {}, &Metric::xx);
    const std::vector<Point> x = random_points(domain, 1'000'000, 9);
    std::vector<double> expected(x.size()), rounded(x.size());
    space->compact(Precision::doubles)->sample_lengths(x, expected);
    for (const Precision precision : {Precision::log16, Precision::log8}) {
        const double step =
            precision == Precision::log16 ? 1.0002 : std::pow(longest.xx / shortest.xx, 1.0 / 255);
        space->compact(precision)->sample_lengths(x, rounded);
        double most = 1;
        for (std::size_t i = 0; i < x.size(); ++i) {
            most = std::max({most, rounded[i] / expected[i], expected[i] / rounded[i]});
        }
        CHECK(most > 1 + (std::sqrt(step) - 1) / 2);
        // The quadratic's weights reach beyond 1.
        CHECK(most <= (interpolates ? std::sqrt(step) * (1 + 1e-7) : step));
    }
}

CASE_OF_EACH(tree, trees(), "frozen trees have the same control nodes and links as before") {
    using Entered = std::tuple<double, double, double, double, std::size_t>;
    const auto entered = [](const ControlSpace& space, Neighbourhood neighbourhood) {
        const ControlNodes nodes = control_nodes(space, neighbourhood).value();
        const NodeGraph& graph = std::get<NodeGraph>(nodes.graph);
        std::vector<Entered> all;
        for (NodeIndex i = 0; i < graph.size(); ++i) {
            const Point& p = graph.position(i);
            all.emplace_back(p.x(), p.y(), p.z(), nodes.metrics[i].xx,
                             graph.first[i + 1] - graph.first[i]);
        }
        std::sort(all.begin(), all.end());
        return all;
    };
    const std::vector<PointSource> sources = sphere(1);
    const auto space = tree.graded(sources);
    const auto frozen = space->compact(Precision::doubles);
    for (const auto neighbourhood : {Neighbourhood::faces, Neighbourhood::all}) {
        CHECK(entered(*frozen, neighbourhood) == entered(*space, neighbourhood));
    }
}

CASE_OF_EACH(tree, trees(),
             "frozen trees are small, and their footprint is what they have allocated") {
    // Isotropic metrics are stored as lengths.
    const auto [s_n, numbers] = GENERATE(std::pair(1.0, 1), std::pair(0.2, 6));
    const std::vector<PointSource> sources = sphere(s_n);
    const auto space = tree.graded(sources);
    const Footprint full = space->footprint();
    const auto all = {Precision::doubles, Precision::floats, Precision::log16, Precision::log8};
    for (const Precision precision : all) {
        const bool is_code = precision == Precision::log16 || precision == Precision::log8;
        if (is_code && numbers > 1) continue;
        const std::size_t before = live_bytes();
        const auto frozen = space->compact(precision);
        const std::size_t allocated = live_bytes() - before;
        const Footprint footprint = frozen->footprint();
        CHECK(footprint.bytes_total() <= allocated);
        CHECK(footprint.bytes_total() + 1024 >= allocated);
        CHECK(footprint.cells == full.cells);
        CHECK(footprint.tree_nodes == full.tree_nodes);
        CHECK(footprint.depth == full.depth);
        CHECK(footprint.control_nodes == full.control_nodes);
        // Lengths in floats take no more than numbers of vertices: leaves hold them.
        const bool in_leaves =
            tree.entry->id.ends_with("V") && numbers == 1 && precision != Precision::doubles;
        const std::size_t number = precision == Precision::doubles  ? sizeof(double)
                                   : precision == Precision::floats ? sizeof(float)
                                   : precision == Precision::log16  ? sizeof(std::uint16_t)
                                                                    : sizeof(std::uint8_t);
        const std::size_t payload = (in_leaves ? 8 * footprint.cells : footprint.control_nodes) *
                                    static_cast<std::size_t>(numbers) * number;
        const std::size_t table = is_code ? 256 * sizeof(double) : 0;
        CHECK(footprint.bytes_payload >= payload);
        CHECK(footprint.bytes_payload <= payload + table);
        CHECK(footprint.bytes_auxiliary <= full.bytes_auxiliary);
    }
}

TEST_CASE("lengths in floats and codes take few bytes a leaf, beside the lookup grid") {
    const std::vector<PointSource> sources = sphere(1, 0.07);
    const std::tuple<const char*, double, double, double> most[] = {
        {"K_L", 21, 19, 19}, {"K_oL", 14, 12, 12}, {"K_V", 61, 45, 39}, {"K_oV", 54, 38, 31}};
    for (const auto& [id, floats, log16, log8] : most) {
        CAPTURE(id);
        const auto space =
            TreeUnderTest{find_entry(tree_catalogue(), id), SplitRule::middle}.graded(sources);
        const auto bytes_per_leaf = [&](Precision precision) {
            const Footprint f = space->compact(precision)->footprint();
            return static_cast<double>(f.bytes_payload + f.bytes_topology) /
                   static_cast<double>(f.cells);
        };
        CHECK(bytes_per_leaf(Precision::floats) <= floats);
        CHECK(bytes_per_leaf(Precision::log16) <= log16);
        CHECK(bytes_per_leaf(Precision::log8) <= log8);
    }
}

CASE_OF_EACH(tree, trees(), "lengths of a tree that meets its first tensor are those of tensors") {
    std::vector<PointSource> sources = sphere(1);
    const auto space = tree.graded(sources);
    const std::vector<Point> x = places();
    std::vector<double> before(x.size()), after(x.size());
    space->built().sample_lengths(x, before);
    sources[0].metric = {0.01, 0.02, 0.03, 0.002, 0.003, 0.004};
    space->insert({sources.data(), 1});
    space->grade({});
    space->built().sample_lengths(x, after);
    CHECK(after != before);
    const std::vector<Metric> metrics = answers(*space, x);
    for (std::size_t i = 0; i < x.size(); ++i) {
        REQUIRE(after[i] == Approx(eigen_frame(metrics[i]).lengths[0]).epsilon(1e-12));
    }
    CHECK(space->compact(Precision::doubles)->footprint().bytes_payload >=
          48 * space->footprint().control_nodes);
}

CASE_OF_EACH(entry, tree_catalogue(), "a tree of one leaf is frozen like any other") {
    const double all = largest_metric(domain).xx;
    for (const Precision precision : {Precision::floats, Precision::log16, Precision::log8}) {
        const auto frozen = editable(entry.make({.domain = domain}))->compact(precision);
        CHECK(sample_at(*frozen, Point(0.3, 0.1, 0.2)).xx == Approx(all).epsilon(1e-7));
    }
}

TEST_CASE("trees with more planes than 16 bits can number are frozen too") {
    RandomFractions fraction(3);
    std::vector<PointSource> sources;
    for (int i = 0; i < 10000; ++i) {
        const auto within = [&] { return 2 * fraction() - 1; };
        const Point x(within(), within(), within());
        sources.push_back({x, Metric::isotropic(1e-4)});
    }
    const CatalogueEntry& kd_vertices = tree_named("K_V");
    REQUIRE(kd_vertices.id == "K_V");
    const auto space = editable(kd_vertices.make({.domain = domain, .split = SplitRule::golden}));
    space->insert(sources);
    // Hardly two cuts stand on one plane.
    REQUIRE(space->footprint().cells > 3 * 80000);
    const auto frozen = space->compact(Precision::doubles);
    const std::vector<Point> x = places();
    CHECK(checksum(answers(*frozen, x)) == checksum(answers(*space, x)));
}

TEST_CASE("what cannot be frozen is refused, with what would help") {
    const auto with = [](const Metric& metric) {
        auto space = editable(tree_named("K_oL").make({.domain = domain, .octree_depth = 2}));
        space->insert(PointSource{Point::Zero(), metric});
        return space;
    };
    const Vector slanted = Vector(1, 2, 3).normalized();
    for (const Metric& bad : {layer_metric(slanted, 1e-6, 1), Metric::isotropic(1e-40)}) {
        const auto space = with(bad);
        CHECK_THROWS_WITH(space->compact(Precision::floats), Contains("use doubles"));
        CHECK_NOTHROW(space->compact(Precision::doubles));
    }
    const auto slab = with(layer_metric(slanted, 1e-3, 1));
    CHECK_NOTHROW(slab->compact(Precision::floats));
    CHECK_THROWS_WITH(slab->compact(Precision::log16), Contains("isotropic: use floats"));
    CHECK_THROWS_WITH(slab->compact(Precision::log8), Contains("isotropic: use floats"));
    const double longest = largest_metric(domain).xx;
    CHECK_NOTHROW(with(Metric::isotropic(longest / 4.9e5))->compact(Precision::log16));
    CHECK_THROWS_WITH(with(Metric::isotropic(longest / 5e5))->compact(Precision::log16),
                      Contains("use floats"));
    const auto anchored = editable(tree_named("K_LA").make({.domain = domain}));
    CHECK_THROWS_WITH(anchored->compact(Precision::doubles), Contains("as it is made"));
}

}  // namespace controlspace::frozen_tree_test
