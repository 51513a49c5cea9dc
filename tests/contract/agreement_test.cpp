// SPDX-License-Identifier: Apache-2.0
// Structures that share nothing but the sources must agree with the exact field and with each
// other, within what the size of their cells and the gradation explain.
#include <algorithm>
#include <catch2/catch.hpp>

#include "contract/structure_case.h"
#include "controlspace/measure/access_time.h"
#include "controlspace/measure/reference.h"
#include "controlspace/metric/nonconformity.h"
#include "editable_space.h"

namespace controlspace::agreement_test {
namespace {

constexpr double g = 1.25;
// Sources within ε_δ of what is held are not inserted: lengths of up to this many times the
// source's.
constexpr double met = 1.42;

// The field of the sources' cones at a point, searched through all of them, and the source that
// governs it.
struct Exact {
    double h;
    double distance;  // to that source
    std::size_t source;
};

std::vector<Exact> exact_field(const Work& work, const std::vector<Point>& x) {
    std::vector<Exact> field;
    for (const Point& p : x) {
        Exact best{work.domain.half_diagonal(), 0, work.sources.size()};
        for (std::size_t j = 0; j < work.sources.size(); ++j) {
            const double distance = (p - work.sources[j].position).norm();
            const double h = work.sources[j].metric.xx + (g - 1) * distance;
            if (h < best.h) best = {h, distance, j};
        }
        field.push_back(best);
    }
    return field;
}

// What a structure answers at the probes, with the diagonals of the cells that do.
struct Field {
    CatalogueEntry structure;
    std::vector<double> h;
    std::vector<double> diagonal;            // of the cell at the probe
    std::vector<double> diagonal_at_source;  // at the source that governs the exact field there
};

Field field_of(const CatalogueEntry& structure, const Work& work, const std::vector<Point>& x,
               const std::vector<Exact>& exact) {
    const auto space = work.graded(structure);
    const auto diagonal = [&](const Point& p) {
        return is_direct(structure) ? 0.0 : space->cell_at(p).value().edges().norm();
    };
    std::vector<Metric> m(x.size());
    space->sample(x, m);
    Field field{structure, {}, {}, {}};
    for (std::size_t i = 0; i < x.size(); ++i) {
        field.h.push_back(m[i].xx);
        field.diagonal.push_back(diagonal(x[i]));
        field.diagonal_at_source.push_back(diagonal(work.sources[exact[i].source].position));
    }
    return field;
}

Work any_isotropic_work() { return GENERATE(isotropic_sphere(), oblong_box(), flat_box()); }

// How far a's length may lie above b's at probe i. Both grow from the source that governs the field
// there: b no slower than along the straight line from somewhere in the source's cell to somewhere
// in the probe's, which nodes are half a diagonal away from, a by g - 1 for each length of the way.
// Where values pass from node to node that way is along the axes at worst: √3 times as long, within
// cells too. And a may hold up to `met` times what the source requests.
double largest_excess(const Work& work, const Exact& exact, const Field& a, const Field& b,
                      std::size_t i) {
    const double detour = a.structure.has<KeptSources>() ? 1 : std::sqrt(3);
    return (met - 1) * work.sources[exact.source].metric.xx +
           (g - 1) *
               ((detour - 1) * exact.distance + detour * (a.diagonal[i] + a.diagonal_at_source[i]) +
                b.diagonal[i] + b.diagonal_at_source[i]);
}

}  // namespace

STRUCTURE_CASE(does_not_round,
               "the exact field, but for the size of cells and ways along the axes") {
    const Work work = any_isotropic_work();
    CAPTURE(work.name);
    const std::vector<Point> x = random_points(work.domain, 1000, 21);
    const std::vector<Exact> exact = exact_field(work, x);
    const Field field = field_of(structure, work, x, exact);
    double too_small = 0;
    double too_large = 0;
    for (std::size_t i = 0; i < x.size(); ++i) {
        const double source = work.sources[exact[i].source].metric.xx;
        const double cells = field.diagonal[i] + field.diagonal_at_source[i];
        const double upper = met * source + (g - 1) * std::sqrt(3) * (exact[i].distance + cells);
        too_large = std::max(too_large, field.h[i] / upper);
        // Nothing is smaller than the exact field but for values that hold all over a cell.
        const double lower = std::max(exact[i].h - (g - 1) * cells, 0.5 * source);
        too_small = std::max(too_small, lower / field.h[i]);
    }
    CHECK(too_large <= 1);
    CHECK(too_small <= 1.01);
}

TEST_CASE("structures agree with each other, pair by pair") {
    const Work work = any_isotropic_work();
    const std::vector<Point> x = random_points(work.domain, 1000, 21);
    const std::vector<Exact> exact = exact_field(work, x);
    std::vector<Field> fields;
    for (const CatalogueEntry& structure : structures_that(does_not_round)) {
        fields.push_back(field_of(structure, work, x, exact));
    }
    double worst_of_all = 0;
    const auto worst = [&](const Field& a, const Field& b, double scale) {
        double largest = 0;
        for (std::size_t i = 0; i < x.size(); ++i) {
            const double excess = scale * a.h[i] - b.h[i];
            largest = std::max(largest, excess / largest_excess(work, exact[i], a, b, i));
        }
        return largest;
    };
    for (const Field& a : fields) {
        for (const Field& b : fields) {
            CAPTURE(work.name, a.structure.id, b.structure.id);
            worst_of_all = std::max(worst_of_all, worst(a, b, 1));
            CHECK(worst(a, b, 1) <= 1);
            // Without detours the bound is close enough to notice a field that is twice as large.
            if (is_direct(a.structure)) CHECK(worst(a, b, 2) > 1);
        }
    }
    CHECK(worst_of_all > 0.25);  // the bound is within a factor of four
}

STRUCTURE_CASE(does_not_round,
               "where elements are small against the size requested, agreement is close",
               "[long]") {
    // With l_min a quarter, and sources as dense, only the propagation along the axes is left near
    // the sphere: sizes up to (0.1 + √3 0.25 d) / (0.1 + 0.25 d) too large, d = 0.02, and an
    // element's extent.
    const Work work{"dense", sample_sphere({.h = 0.05, .rho = 0.4})};
    std::vector<Point> x;
    for (const Point& p : random_points(work.domain, 4000, 22)) {
        if (std::abs(p.norm() - 0.8) < 0.02) x.push_back(p);
    }
    REQUIRE(x.size() > 100);
    std::vector<Metric> exact(x.size());
    exact_reference(work.sources, g, Metric::isotropic(work.domain.half_diagonal()))
        ->sample(x, exact);
    SpaceOptions options = work.options();
    options.l_min = 0.25;
    const auto space = editable(structure.make(options));
    space->insert(work.sources);
    space->grade({});
    std::vector<Metric> m(x.size());
    space->sample(x, m);
    double worst = 0;
    for (std::size_t i = 0; i < x.size(); ++i) {
        worst = std::max(worst, nonconformity(m[i], exact[i]));
    }
    CHECK(worst < 0.2);
}

}  // namespace controlspace::agreement_test
