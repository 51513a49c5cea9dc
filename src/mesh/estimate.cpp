// SPDX-License-Identifier: Apache-2.0
#include "mesh/estimate.h"

#include <Eigen/LU>
#include <cmath>
#include <vector>

#include "controlspace/measure/accuracy.h"
#include "controlspace/space/sample_parallel.h"
#include "refuse.h"

namespace controlspace {

double estimated_tets(const Box& domain, const ControlSpace& field) {
    constexpr int samples = 24;
    const std::vector<Point> places = cell_centres(domain, samples);
    const std::vector<Metric> metrics = sample_parallel(field, places);
    const double cell = domain.edges().prod() / static_cast<double>(places.size());
    const double per_unit = 6 * std::sqrt(2.0);  // regular ones of edge 1 in a unit of volume
    double sum = 0;
    for (const Metric& m : metrics) sum += per_unit * cell / m.matrix().determinant();
    return sum;
}

void require_few_tets(const Box& domain, const ControlSpace& field, double most) {
    const double tets = estimated_tets(domain, field);
    if (tets <= most) return;
    refuse(
        "the field requests about {:.2g} tetrahedra, more than {:.2g}: "
        "request larger lengths, or raise the limit",
        tets, most);
}

}  // namespace controlspace
