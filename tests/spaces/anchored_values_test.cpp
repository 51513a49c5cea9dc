// SPDX-License-Identifier: Apache-2.0
#include "trees/values/anchored_values.h"

#include <algorithm>
#include <catch2/catch.hpp>

#include "case_of_each.h"
#include "controlspace/measure/accuracy.h"
#include "controlspace/measure/reference.h"
#include "controlspace/metric/nonconformity.h"
#include "controlspace/sources/sampled_surfaces.h"
#include "controlspace/space/catalogue.h"
#include "editable_space.h"
#include "metric/draw.h"
#include "trees/values/growing_cones.h"

namespace controlspace::anchored_values_test {
namespace {

const Box domain{Point(-1, -1, -1), Point(1, 1, 1)};
constexpr double g = 1.25;

}  // namespace

CASE_OF_EACH(entry, anchored_catalogue(),
             "one source: its cone everywhere, to rounding, where leaf values give steps") {
    const PointSource source{Point(0.3, -0.2, 0.1), Metric::isotropic(0.05)};
    const auto space = editable(entry.make({.domain = domain}));
    space->insert(source);
    space->grade({});
    for (const Point& x : cell_centres(domain, 9)) {
        const double h = 0.05 + (g - 1) * (x - source.position).norm();
        CHECK(sample_at(*space, x).xx == Approx(h).epsilon(1e-14));
    }
}

CASE_OF_EACH(entry, anchored_catalogue(), "one tensor: its cone everywhere") {
    const PointSource source{Point(0.3, -0.2, 0.1), {0.1, 0.3, 0.2, 0.02, -0.03, 0.05}};
    const auto space = editable(entry.make({.domain = domain}));
    space->insert(source);
    space->grade({});
    const Metric largest = largest_metric(domain);
    for (const Point& x : cell_centres(domain, 9)) {
        const double factor = 1 + (g - 1) * metric_length(source.metric, x - source.position);
        const Metric cone = intersection(largest, factor * source.metric);
        CHECK(nonconformity(sample_at(*space, x), cone) < 1e-12);
    }
}

CASE_OF_EACH(entry, anchored_catalogue(),
             "sphere: nearer to the exact field than the other trees, with fewer bytes than K_L",
             "[long]") {
    const std::vector<PointSource> sources = sample_sphere({.rho = 1});
    const auto field = exact_reference(sources, g, largest_metric(domain));
    const Probes coarse = make_probes(*field, cell_centres(domain, 30));
    const Probes fine = make_probes(*field, cell_centres(domain, 101));
    const auto k_l = editable(tree_named("K_L").make({.domain = domain}));
    k_l->insert(sources);
    const auto space = editable(entry.make({.domain = domain}));
    space->insert(sources);
    const GradationReport report = space->grade({});
    CHECK(accuracy(*space, coarse).max <= 0.10);
    const Accuracy everywhere = accuracy(*space, fine);
    CHECK(everywhere.max <= 0.15);
    CHECK(everywhere.mean <= 0.005);
    CHECK(space->footprint().bytes_total() < k_l->footprint().bytes_total());
    CHECK(report.largest_ratio_left <= g * (1 + 1e-9));
}

CASE_OF_EACH(entry, anchored_catalogue(), "more sources than anchors at one place: all are met") {
    // Discs that cross at one place, each 0.1 across and 1 along.
    std::vector<PointSource> sources;
    const Point place(0.1, 0.2, 0.3);
    const int count = GENERATE(5, 40);
    for (int i = 0; i < count; ++i) {
        const Vector n = Vector(1, i - 2, 0.5 * i).normalized();
        Metric m = Metric::from_matrix(Eigen::Matrix3d::Identity() - 0.9 * n * n.transpose());
        sources.push_back({place + 1e-4 * n, m});
    }
    const auto rule = GENERATE(IntersectionRule::order_free, IntersectionRule::in_turn);
    const auto space = editable(entry.make({.domain = domain, .intersection = rule}));
    space->insert(sources);
    for (const PointSource& s : sources) {
        const Metric held = sample_at(*space, s.position);
        CHECK(nonconformity(held, intersection(held, s.metric)) < 0.2);
    }
}

CASE_OF_EACH(entry, anchored_catalogue(),
             "a steep cone just beyond the face of a leaf that is not cut is not missed") {
    const std::vector<PointSource> sources{
        {Point(-0.42567976, 0.75695719, 0.82612610), Metric::isotropic(0.0552594), 10},
        {Point(-0.75242710, -0.11953831, -0.97706003), Metric::isotropic(0.187095), 10}};
    const auto space = editable(entry.make({.domain = domain, .l_min = 2, .tolerance = 1}));
    space->insert(sources);
    space->grade({});
    // Both are cones of slope 9; the other is 2.5 away and more.
    for (const double step : {0.002, 0.004, 0.0077, 0.01, 0.02, 0.04}) {
        for (const Vector& way : {Vector(0.23, -0.95, 0.17), Vector(0, -1, 0), Vector(1, 0, 0),
                                  Vector(-1, 0, 0), Vector(0, 0, -1), Vector(0, 0, 1)}) {
            const Point x = sources[0].position + step * way.normalized();
            const double exact = 0.0552594 + 9 * step;
            CAPTURE(step, way);
            CHECK(sample_at(*space, x).xx <= 1.5 * exact);
        }
    }
}

TEST_CASE("sources of one metric share it, and idle ones go") {
    SourceTable table;
    const Metric m = Metric::isotropic(0.1);
    for (int i = 0; i < 100; ++i) table.add({Point(i, 0, 0), m});
    table.add({Point(0, 1, 0), {1, 2, 3, 0.1, 0.2, 0.3}});
    CHECK_FALSE(table.all_isotropic());
    std::vector<std::uint8_t> kept(101, 0);
    kept[7] = kept[42] = 1;
    const auto renamed = table.keep(kept);
    CHECK(table.size() == 2);
    CHECK(table.all_isotropic());
    CHECK(renamed[42] == 1);
    CHECK(table.source(0) == PointSource{Point(7, 0, 0), m});
    CHECK(table.bytes() ==
          2 * (sizeof(Point) + sizeof(std::uint32_t)) + sizeof(Metric) + sizeof(double));
    CHECK(table.factor(1, g, Point(42, 3, 4)) == Approx(1 + 0.25 * 50));
    CHECK(table.smallest_length(1) == Approx(0.1));
}

CASE_OF_EACH(entry, anchored_catalogue(), "thin tensors are graded without cuts") {
    // Discs, needles and others, of 1000:1, turned at random.
    Draw draw(9);
    std::vector<PointSource> sources;
    for (int i = 0; i < 12; ++i) {
        const double h = draw.uniform(0.1, 0.3);
        const std::array lengths{h / 1000, h * std::pow(1000, -draw.uniform(0, 1)), h};
        const Point q(draw.uniform(-1, 1), draw.uniform(-1, 1), draw.uniform(-1, 1));
        sources.push_back({q, metric_from_frame(lengths, draw.rotation())});
    }
    for (const auto rule : {IntersectionRule::order_free, IntersectionRule::in_turn}) {
        const auto space = editable(entry.make({.domain = domain, .intersection = rule}));
        space->insert(sources);
        const std::size_t leaves = space->footprint().cells;
        space->grade({});
        CHECK(space->footprint().cells == leaves);
        if (rule == IntersectionRule::in_turn) continue;  // jumps
        const auto field = exact_reference(sources, g, largest_metric(domain), 1e-3);
        std::vector<Point> x;
        for (int i = 0; i < 1000; ++i) {
            x.emplace_back(draw.uniform(-1, 1), draw.uniform(-1, 1), draw.uniform(-1, 1));
        }
        const auto own = answers(*space, x);
        const auto exact = answers(*field, x);
        double sum = 0;
        for (std::size_t i = 0; i < x.size(); ++i) {
            const double delta = directional_nonconformity(own[i], exact[i]);
            CHECK(delta < 0.5);
            sum += delta;
        }
        CHECK(sum < 1e-3 * static_cast<double>(x.size()));  // what the reference is exact to
    }
}

TEST_CASE("the smallest of growing cones, to the bit, by a few of them") {
    Draw draw(7);
    SourceTable table;
    GrowingCones cones(table, g);
    constexpr SourceIndex n = 20000;
    std::size_t before = 0;
    for (SourceIndex s = 0; s < n; ++s) {
        // In rows, as many sources are given.
        const Point q = 1e-6 * Point(s % 27, s / 27 % 27, s / 729);
        table.add({q, Metric::isotropic(1e-9 * (s % 5 == 0 ? draw.uniform(1, 500) : 1))});
        cones.add(s);
        if (s % 500 != 499) continue;
        const Point x = q + 1e-6 * draw.vector();
        double smallest = 1;
        for (SourceIndex k = 0; k <= s; ++k) smallest = std::min(smallest, cones.length_at(k, x));
        before = cones.evaluated();
        REQUIRE(cones.smallest(x, 1) == smallest);
        REQUIRE(cones.evaluated() - before < 200);
        REQUIRE(cones.smallest(x, 0.9 * smallest) == 0.9 * smallest);
    }
}

CASE_OF_EACH(entry, anchored_catalogue(), "many sources of a leaf, inserted at once and in turn") {
    // All in one leaf, or, every other one, in another.
    for (const Vector& apart : {Vector(0, 0, 0), Vector(0.3, 0, 0)}) {
        std::vector<PointSource> sources;
        Draw draw(8);
        for (int i = 0; i < 2000; ++i) {
            const Point q = 1e-6 * Point(i % 13, i / 13 % 13, i / 169) + (i % 2) * apart;
            // One in ten requests what is there already, to the insertion tolerance or nearly.
            const double h = i % 10 == 9 ? 2.5e-7 * draw.uniform(0.5, 2) : 1e-9;
            sources.push_back({Point(0.1, 0.1, 0.1) + q, Metric::isotropic(h)});
        }
        const auto at_once = editable(entry.make({.domain = domain}));
        const auto in_turn = editable(entry.make({.domain = domain}));
        const InsertionReport report = at_once->insert(sources);
        std::size_t inserted = 0;
        for (const PointSource& s : sources) {
            if (in_turn->insert(s) == Insertion::inserted) ++inserted;
        }
        CHECK(report.inserted == inserted);
        CHECK(inserted < sources.size());
        CHECK(inserted > sources.size() / 2);
        for (int i = 0; i < 300; ++i) {
            const Point x =
                sources[static_cast<std::size_t>(6 * i)].position + 1e-7 * draw.vector();
            REQUIRE(sample_at(*at_once, x) == sample_at(*in_turn, x));
        }
    }
}

TEST_CASE("lists of anchors that grow in turn take room in proportion to their lengths") {
    AnchorLists lists;
    lists.repeat(0, 3);
    constexpr SourceIndex n = 8000;
    for (SourceIndex s = 0; s < n; ++s) lists.add(s % 4, s);
    CHECK(lists.bytes() < 64 * n);
    const auto is_right = [&](LeafIndex leaf) {
        const auto list = lists.of(leaf);
        bool is = list.size() == n / 4;
        for (SourceIndex k = 0; k < list.size(); ++k) is = is && list[k] == 4 * k + leaf;
        return is;
    };
    for (LeafIndex leaf = 0; leaf < 4; ++leaf) CHECK(is_right(leaf));
    // Leaves that share a list, which then grows in the first of them.
    lists.repeat(1, 2);
    lists.add(1, 7);
    lists.add(4, 8);
    CHECK(lists.of(1).back() == 7);
    CHECK(lists.of(4).back() == 8);
    CHECK(lists.of(4).size() == n / 4 + 1);
    CHECK(lists.of(5).size() == n / 4);
    lists.shrink_to_fit();
    CHECK(is_right(2));
    CHECK(lists.of(1).back() == 7);
    CHECK(lists.of(4).back() == 8);
}

}  // namespace controlspace::anchored_values_test
