// SPDX-License-Identifier: Apache-2.0
// Gradation by the sources: what control nodes hold, and how far from the exact field a structure
// may be between them.
#include <algorithm>
#include <catch2/catch.hpp>

#include "contract/structure_case.h"
#include "controlspace/measure/access_time.h"
#include "controlspace/measure/reference.h"
#include "controlspace/metric/intersection.h"
#include "controlspace/sources/cone.h"
#include "editable_space.h"

namespace controlspace::exact_nodes_test {
namespace {

constexpr double g = 1.25;
constexpr double tolerance = 1e-2;  // of nodes graded by the sources

Work any_work() {
    return GENERATE(isotropic_sphere(), anisotropic_sphere(), anisotropic_oblong_box(),
                    anisotropic_flat_box(), with_own_growths(isotropic_sphere()),
                    with_own_growths(anisotropic_oblong_box()));
}

bool holds_metrics(const CatalogueEntry& structure) { return structure.has<MetricNodes>(); }

bool holds_metrics_unrounded(const CatalogueEntry& structure) {
    return does_not_round(structure) && holds_metrics(structure);
}

double rounding(const CatalogueEntry& structure) { return is_rounding(structure) ? 1e-5 : 1e-9; }

std::vector<Metric> exact_at(const Work& work, const std::vector<Point>& x) {
    std::vector<Metric> exact(x.size());
    exact_reference(work.sources, g, largest_metric(work.domain), tolerance)->sample(x, exact);
    return exact;
}

// Cones are Lipschitz: where the field is M at x, no cone at x + v is longer than 1 + e times that
// at x, e = (g - 1) |M^-1 v|. So what holds the field at x + v is within 1 + e times all cones at
// x; blends of such are, too. Quadratic functions stay within the cone of their leaf's metric.
double explained_by_leaf(const ControlSpace& space, int order, const Point& x, const Metric& m,
                         double steepest) {
    const Box cell = space.cell_at(x).value();
    const auto from = [&](const Point& node) {
        return 1 + (steepest - 1) * metric_length(m, node - x);
    };
    if (order == 0) return from(cell.centre());
    if (order == 2) {
        const Metric own = sample_at(space, cell.centre());
        return from(cell.centre()) * (1 + (steepest - 1) * metric_length(own, x - cell.centre()));
    }
    double most = 1;
    for (int i = 0; i < 8; ++i) most = std::max(most, from(corner(cell, i)));
    return most;
}

}  // namespace

// Levels refine their voxels in gradation: other nodes than before.
STRUCTURE_CASE(
    holds_metrics,
    "graded by the sources, control nodes hold the exact field, or what is requested of them",
    "[long]") {
    const Work work = any_work();
    CAPTURE(work.name);
    const auto space = work.inserted(structure);
    const std::vector<Metric> requested = space->control_nodes(Neighbourhood::faces).metrics;
    space->grade({.ratio = g});
    const ControlNodes nodes = space->control_nodes(Neighbourhood::faces);
    const std::vector<Metric> exact = exact_at(work, positions(nodes.graph));
    double longer = 0;
    double shorter = 0;
    for (std::size_t i = 0; i < exact.size(); ++i) {
        longer = std::max(longer, growth(nodes.metrics[i], exact[i]) - 1);
        if (requested.size() != exact.size()) continue;
        const Metric wanted = intersection(requested[i], exact[i]);
        shorter = std::max(shorter, growth(wanted, nodes.metrics[i]) - 1);
    }
    CHECK(longer <= rounding(structure));
    CHECK(shorter <= rounding(structure));
}

STRUCTURE_CASE(holds_metrics_unrounded,
               "graded by the sources, nothing is longer than the leaf explains, nor 4 times",
               "[long]") {
    const Work work = any_work();
    CAPTURE(work.name);
    const auto space = work.graded(structure);
    const std::vector<Point> x = random_points(work.domain, 500, 31);
    const std::vector<Metric> exact = exact_at(work, x);
    double beyond_leaf = 0;
    double longest = 0;
    for (std::size_t i = 0; i < x.size(); ++i) {
        const Metric m = sample_at(*space, x[i]);
        const double explained = explained_by_leaf(*space, structure.order, x[i], exact[i],
                                                   largest_growth(work.sources, g));
        longest = std::max(longest, growth(m, exact[i]));
        for (std::size_t s = i % 7; s < work.sources.size(); s += 7) {
            const Metric cone = cone_factor(work.sources[s], g, x[i]) * work.sources[s].metric;
            beyond_leaf = std::max(beyond_leaf, growth(m, cone) / explained);
        }
    }
    CHECK(beyond_leaf <= 1 + 1e-6);
    CHECK(longest < 4);
}

STRUCTURE_CASE(holds_metrics,
               "graded by the sources again: nothing to do, then for another ratio, and more",
               "[long]") {
    const Work work = anisotropic_oblong_box();
    const std::span<const PointSource> all = work.sources;
    const std::vector<Point> x = random_points(work.domain, 500, 32);
    const auto space = editable(structure.make(work.options()));
    space->insert(all.first(all.size() - 40));
    space->grade({.ratio = 1.6});
    const std::vector<Metric> before = answers(*space, x);
    CHECK(space->grade({.ratio = 1.6}).operations == 0);
    CHECK(answers(*space, x) == before);
    space->grade({.ratio = g});
    CHECK(answers(*space, x) != before);
    space->insert(all.last(40));
    space->grade({.ratio = g});
    const ControlNodes nodes = space->control_nodes(Neighbourhood::faces);
    const std::vector<Metric> exact = exact_at(work, positions(nodes.graph));
    double worst = 0;
    for (std::size_t i = 0; i < exact.size(); ++i) {
        worst = std::max(worst, growth(nodes.metrics[i], exact[i]) - 1);
    }
    CHECK(worst <= rounding(structure));
}

}  // namespace controlspace::exact_nodes_test
