// SPDX-License-Identifier: Apache-2.0
#include "trees/values/anchored_values.h"

#include <catch2/catch.hpp>

#include "case_of_each.h"
#include "controlspace/measure/accuracy.h"
#include "controlspace/metric/nonconformity.h"
#include "controlspace/sources/sampled_surfaces.h"
#include "controlspace/space/catalogue.h"
#include "editable_space.h"

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

}  // namespace controlspace::anchored_values_test
