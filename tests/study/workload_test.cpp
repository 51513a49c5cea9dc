// SPDX-License-Identifier: Apache-2.0
#include "controlspace/study/workload.h"

#include <catch2/catch.hpp>

#include "cli/paper_reference.h"
#include "controlspace/error.h"
#include "controlspace/measure/reference.h"
#include "controlspace/metric/intersection.h"
#include "controlspace/metric/order_free_intersection.h"
#include "fields/values.h"
#include "metric/draw.h"

namespace controlspace::workload_test {

using Catch::Matchers::Contains;

namespace {

Study small_study() {
    Study study;
    study.sources.h = 0.2;
    return study;
}

}  // namespace

TEST_CASE("the domain is where the field is defined, or the cube of the sampled surfaces") {
    Study study = small_study();
    const Box cube{Point::Constant(-1), Point::Constant(1)};
    const Box unit{Point::Zero(), Point::Ones()};
    SourcesChoice choice = study.sources;
    CHECK(make_workload(study, choice).domain == cube);
    choice.field.kind = FieldKind::sphere;
    CHECK(make_workload(study, choice).domain == cube);
    choice.kind = SourcesKind::none;
    CHECK(make_workload(study, choice).domain == cube);
    choice.field.kind = FieldKind::ugawg_linear;
    const Workload workload = make_workload(study, choice);
    CHECK(workload.domain == unit);
    CHECK(workload.sources.empty());
    CHECK(workload.finest_length == 0.001);

    study.domain = unit;
    choice.field.kind = FieldKind::ugawg_polar_1;
    CHECK_NOTHROW(make_workload(study, choice));
    study.domain = Box{Point::Zero(), Point(1, 1, 1.25)};
    CHECK_THROWS_WITH(make_workload(study, choice),
                      Contains("ugawg-polar-1") && Contains("[0, 1.25]"));
}

TEST_CASE("sources must lie in the field's domain") {
    Study study = small_study();
    SourcesChoice choice = study.sources;
    choice.field.kind = FieldKind::ugawg_linear;
    CHECK_THROWS_WITH(make_workload(study, choice), Contains("outside the domain"));
    choice.centre = Point::Constant(0.5);
    choice.radius = 0.3;
    const Workload workload = make_workload(study, choice);
    for (const PointSource& s : workload.sources.all()) {
        CHECK((s.position - choice.centre).norm() == Approx(0.3).epsilon(1e-14));
    }
}

TEST_CASE("the smallest requested length is that of the sources or of the field") {
    const Study study = small_study();
    SourcesChoice choice = study.sources;
    choice.field.kind = FieldKind::planes;
    choice.field.lengths.across = 0.5;
    CHECK(make_workload(study, choice).finest_length == 0.03);
    choice.field.lengths = {.across = 0.002, .along = 1};
    CHECK(make_workload(study, choice).finest_length == 0.002);
    choice.field.kind = FieldKind::none;
    CHECK(make_workload(study, choice).finest_length == Approx(0.4).epsilon(1e-14));
}

TEST_CASE("the reference of a field with sources is the intersection of both") {
    const Study study = small_study();
    Case c;
    c.sources = study.sources;
    c.sources.s_n = 0.25;
    c.sources.field.kind = FieldKind::planes;
    c.sources.field.lengths = {.across = 0.02, .along = 0.3};
    c.intersection = IntersectionRule::in_turn;  // order-free: see the next test
    const Workload mixed = make_workload(study, c.sources);
    const auto reference = make_reference(study, c, mixed);
    const double largest = mixed.domain.half_diagonal();
    const auto cones =
        exact_reference(mixed.sources, c.g_r, Metric::isotropic(largest), 0, c.intersection);
    Draw draw(1);
    for (int i = 0; i < 100; ++i) {
        const Point p(draw.uniform(-1, 1), draw.uniform(-1, 1), draw.uniform(-1, 1));
        const Metric expected = intersection(value_at(*cones, p), value_at(*mixed.field.field, p));
        CHECK(value_at(*reference, p) == expected);
    }

    // Without sources it is the field, and nowhere above half of the domain's diagonal.
    c.sources.kind = SourcesKind::none;
    c.sources.field.lengths.growth = 100;
    const Workload alone = make_workload(study, c.sources);
    const auto field = make_reference(study, c, alone);
    CHECK(value_at(*field, {-0.5, 0.9, 0}).xx == Approx(0.02).epsilon(1e-12));
    CHECK(difference(value_at(*field, {1, 1, 1}), Metric::isotropic(largest)) < 1e-12);
}

TEST_CASE("the order-free reference is the largest metric within all cones and the field") {
    Study study = small_study();
    study.reference_tolerance = 1e-3;
    Case c;
    c.sources = study.sources;
    c.sources.s_n = 0.25;
    c.sources.field.kind = FieldKind::planes;
    c.sources.field.lengths = {.across = 0.02, .along = 0.3};
    const Workload mixed = make_workload(study, c.sources);
    const auto reference = make_reference(study, c, mixed);
    Draw draw(1);
    for (int i = 0; i < 30; ++i) {
        const Point p(draw.uniform(-1, 1), draw.uniform(-1, 1), draw.uniform(-1, 1));
        std::vector<Metric> all{largest_metric(mixed.domain), value_at(*mixed.field.field, p)};
        for (const PointSource& s : mixed.sources.all()) {
            all.push_back((1 + (c.g_r - 1) * metric_length(s.metric, p - s.position)) * s.metric);
        }
        const Metric m = value_at(*reference, p);
        for (const Metric& other : all) CHECK(is_within(m, 1 + 1e-12, other));
        const double best = order_free_intersection(all).metric().matrix().determinant();
        CHECK(m.matrix().determinant() >= best * (1 - 3.1 * study.reference_tolerance));
    }
}

TEST_CASE("the reference of the paper's Table 4 grows with the distance from the sphere") {
    Case c;
    c.reference = &published_sphere();
    const Study study;
    Workload workload;
    workload.domain = {Point::Constant(-1), Point::Constant(1)};
    const auto field = make_reference(study, c, workload);
    const double slope = 2 * 0.25 / 2.25;
    CHECK(value_at(*field, Point(0.8, 0, 0)) == Metric::isotropic(0.03));
    CHECK(value_at(*field, Point::Zero()).xx == Approx(0.03 + slope * 0.8));
    CHECK(value_at(*field, Point(0, -0.6, 0.8)).xx == Approx(0.03 + slope * 0.2));
    CHECK(value_at(*field, Point(100, 0, 0)) == Metric::isotropic(workload.domain.half_diagonal()));
}

TEST_CASE("sources follow the sampling and the seed of the study") {
    Study study = small_study();
    SourcesChoice choice = study.sources;
    const auto regular = make_workload(study, choice).sources.all();
    choice.sampling = Sampling::random;
    const auto first = make_workload(study, choice).sources.all();
    CHECK(first.size() == regular.size());
    CHECK_FALSE(first == regular);
    study.seed = 2;
    CHECK_FALSE(make_workload(study, choice).sources.all() == first);
}

TEST_CASE("the reference of anisotropic sources is exact unless the study has a tolerance") {
    Study study = small_study();
    Case c;
    c.sources = study.sources;
    c.sources.s_n = 0.25;
    const Workload workload = make_workload(study, c.sources);
    const Metric largest = Metric::isotropic(workload.domain.half_diagonal());
    const auto is_that_of = [&](double tolerance, double asked_of_study) {
        study.reference_tolerance = asked_of_study;
        const auto field = exact_reference(workload.sources, c.g_r, largest, tolerance);
        const auto reference = make_reference(study, c, workload);
        Draw draw(1);
        bool same = true;
        for (int i = 0; i < 50; ++i) {
            const Point p(draw.uniform(-1, 1), draw.uniform(-1, 1), draw.uniform(-1, 1));
            same = same && value_at(*reference, p) == value_at(*field, p);
        }
        return same;
    };
    CHECK(is_that_of(0, 0));
    CHECK(is_that_of(0.05, 0.05));
    CHECK_FALSE(is_that_of(0, 0.05));
}

}  // namespace controlspace::workload_test
