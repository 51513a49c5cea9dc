// SPDX-License-Identifier: Apache-2.0
// How fast the error of a smooth field falls with the size of cells: by the order of interpolation.
#include <catch2/catch.hpp>
#include <cmath>

#include "contract/structure_case.h"
#include "controlspace/measure/access_time.h"
#include "editable_space.h"

namespace controlspace::convergence_test {
namespace {

double field(const Point& x) {
    return 0.4 + 0.1 * std::sin(3 * x[0] + 1) * std::cos(2 * x[1]) + 0.05 * x[2] * x[2];
}

// A source in the middle of each of n³ cells of the unit cube, as long as a cell: all are cut
// alike.
std::vector<PointSource> lattice(int n) {
    std::vector<PointSource> sources;
    const double h = 1.0 / n;
    for (int i = 0; i < n; ++i) {
        for (int j = 0; j < n; ++j) {
            for (int k = 0; k < n; ++k) {
                sources.push_back(
                    {Point((i + 0.5) * h, (j + 0.5) * h, (k + 0.5) * h), Metric::isotropic(h)});
            }
        }
    }
    return sources;
}

// Largest error with the field's values at the control nodes of n³ cells.
double error(const CatalogueEntry& structure, int n) {
    const Box domain{Point::Zero(), Point::Ones()};
    const auto space = editable(structure.make({.domain = domain, .finest_length = 1.0 / n}));
    space->insert(lattice(n));
    const ControlNodes nodes = space->control_nodes(Neighbourhood::faces);
    std::vector<Metric> values;
    for (const Point& p : positions(nodes.graph)) values.push_back(Metric::isotropic(field(p)));
    space->assign(values);
    const std::vector<Point> x = random_points(domain, 3000, 4);
    std::vector<Metric> m(x.size());
    space->sample(x, m);
    double worst = 0;
    for (std::size_t i = 0; i < x.size(); ++i) {
        worst = std::max(worst, std::abs(m[i].xx - field(x[i])));
    }
    return worst;
}

bool has_smooth_nodes(const CatalogueEntry& structure) {
    return does_not_round(structure) && structure.has<MetricNodes>() &&
           !structure.has<KeptSources>();
}

}  // namespace

STRUCTURE_CASE(has_smooth_nodes,
               "errors fall with the size of cells as the order of interpolation says") {
    const double rate = std::log2(error(structure, 16) / error(structure, 32));
    CAPTURE(rate);
    // K_Li's values on edges are means of two faces: it does not reproduce linear fields, and
    // converges little faster than a constant.
    const int order = structure.order;
    CHECK(rate > (order == 1 ? 1.8 : 0.9));
    CHECK(rate < (order == 0 ? 1.2 : order == 1 ? 2.2 : 1.5));
}

}  // namespace controlspace::convergence_test
