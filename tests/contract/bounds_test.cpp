// SPDX-License-Identifier: Apache-2.0
// What holds between control nodes, and what no structure takes.
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <catch2/catch.hpp>

#include "contract/structure_case.h"
#include "controlspace/error.h"
#include "controlspace/measure/access_time.h"
#include "controlspace/metric/intersection.h"
#include "editable_space.h"

namespace controlspace::bounds_test {

using Catch::Matchers::Contains;

namespace {

constexpr double g = 1.25;

// Upper bound of growth(m, by) for the metric m at x, from the metrics at the nodes of the cell:
// σ_max(Σ w_i M_i by^-1) <= Σ w_i σ_max(M_i by^-1) for weights >= 0 whose sum is 1; quadratic
// leaves are bounded by the cone of their own metric.
double growth_at_nodes(const ControlSpace& space, int order, const Point& x, const Metric& by) {
    const Box cell = space.cell_at(x).value();
    const Metric own = sample_at(space, cell.centre());
    if (order == 0) return growth(own, by);
    if (order == 2) {
        return growth(own, by) * (1 + (g - 1) * metric_length(own, x - cell.centre()));
    }
    double most = 0;
    for (int i = 0; i < 8; ++i) {
        // A corner might belong to the cell beside.
        const Point inside = corner(cell, i) + 1e-9 * (cell.centre() - corner(cell, i));
        most = std::max(most, growth(sample_at(space, inside), by));
    }
    return most;
}

void check_between_nodes(const ControlSpace& space, int order, const Work& work) {
    double worst = 0;
    for (const Point& x : random_points(work.domain, 200, 5)) {
        const Metric m = sample_at(space, x);
        for (std::size_t i = 0; i < work.sources.size(); i += 1 + work.sources.size() / 30) {
            const auto& [position, metric, own_growth] = work.sources[i];
            const Metric cone = (1 + (g - 1) * metric_length(metric, x - position)) * metric;
            worst = std::max(worst, growth(m, cone) / growth_at_nodes(space, order, x, cone));
        }
    }
    CHECK(worst > 0);
    CHECK(worst <= 1 + 1e-6);
}

bool blends_values(const CatalogueEntry& structure) {
    return does_not_round(structure) && keeps_values(structure) && !is_direct(structure);
}

}  // namespace

STRUCTURE_CASE(blends_values,
               "tensors between nodes exceed the sources' cones by no more than those at the nodes",
               "[long]") {
    const Work work = GENERATE(anisotropic_sphere(), anisotropic_oblong_box());
    CAPTURE(work.name);
    const auto space = work.graded(structure, {.ratio = g});
    check_between_nodes(*space, structure.order, work);
    space->adapt({.sources = work.sources, .continuous = nullptr, .ratio = g, .target = 1});
    check_between_nodes(*space, structure.order, work);
}

STRUCTURE_CASE(every_structure, "sampled lengths are the smallest that the metrics request") {
    const Work work = GENERATE(isotropic_sphere(), anisotropic_oblong_box(), flat_box());
    CAPTURE(work.name);
    const auto space = work.graded(structure);
    const Vector beyond = 0.1 * work.domain.edges();
    const std::vector<Point> x =
        random_points({work.domain.low - beyond, work.domain.high + beyond}, 300, 12);
    std::vector<double> lengths(x.size());
    space->built().sample_lengths(x, lengths);
    const std::vector<Metric> metrics = answers(*space, x);
    for (std::size_t i = 0; i < x.size(); ++i) {
        const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(metrics[i].matrix(),
                                                                    Eigen::EigenvaluesOnly);
        CHECK(lengths[i] == Approx(solver.eigenvalues()[0]).epsilon(1e-10));
    }
}

STRUCTURE_CASE(every_structure, "unknown rules and laws are refused, and change nothing") {
    const Work work = isotropic_sphere();
    SpaceOptions options = work.options();
    options.split = static_cast<SplitRule>(77);
    CHECK_THROWS_WITH(structure.make(options), Contains("split is 77"));
    const auto space = work.inserted(structure);
    const std::vector<Point> x = random_points(work.domain, 50, 1);
    const std::vector<Metric> before = answers(*space, x);
    CHECK_THROWS_WITH(space->grade({.law = static_cast<GradationLaw>(77)}),
                      Contains("law of gradation is 77"));
    CHECK_THROWS_WITH(space->grade({.schedule = static_cast<GradationSchedule>(77)}),
                      Contains("schedule of gradation is 77"));
    CHECK_THROWS_WITH(space->grade({.neighbourhood = static_cast<Neighbourhood>(77)}),
                      Contains("neighbourhood is 77"));
    CHECK(answers(*space, x) == before);
}

}  // namespace controlspace::bounds_test
