// SPDX-License-Identifier: Apache-2.0
// Sources that lie anyhow and request 50:1: every structure must take them.
#include <catch2/catch.hpp>

#include "contract/structure_case.h"
#include "controlspace/measure/access_time.h"
#include "controlspace/metric/intersection.h"
#include "controlspace/sources/scattered_surfaces.h"
#include "editable_space.h"

namespace controlspace::irregular_sources_test {
namespace {

// A grid as fine as 50:1 requests would take gigabytes.
std::unique_ptr<EditableSpace> made(const CatalogueEntry& structure, const Work& work) {
    SpaceOptions options = work.options();
    options.voxel = 0.2;
    return editable(structure.make(options));
}

// Largest ratio of a length that `space` answers at a source to what the source requests.
double largest_growth(const ControlSpace& space, const std::vector<PointSource>& sources) {
    double largest = 0;
    for (const PointSource& source : sources) {
        largest = std::max(largest, growth(sample_at(space, source.position), source.metric));
    }
    return largest;
}

}  // namespace

STRUCTURE_CASE(does_not_round,
               "irregular sources of 50:1 give metrics everywhere, and are met at their places",
               "[long]") {
    const Sampling sampling = GENERATE(Sampling::random, Sampling::clustered, Sampling::poisson);
    const Work work{"irregular",
                    scatter_sphere({.h = 0.06, .s_a = 10, .s_n = 0.02, .rho = 4}, sampling, 7)};
    const double largest = work.domain.half_diagonal();
    const std::vector<Point> x = random_points(work.domain, 500, 3);
    std::vector<Metric> m(x.size());
    CAPTURE(static_cast<int>(sampling));
    const auto space = made(structure, work);
    CHECK(space->insert(std::span(work.sources)).inserted > 0);
    space->grade({});
    space->sample(x, m);
    for (const Metric& metric : m) {
        REQUIRE(is_positive_definite(metric));
        REQUIRE(eigen_frame(metric).lengths[2] <= largest * (1 + 1e-9));
    }
    // A δ of 0.2, which insertion lets pass, is a length 1.56 times as long in one direction.
    // Quadratic interpolation may leave the range of its nodes, and leaves that keep three
    // sources may hold more: they have no such bound at this anisotropy.
    if (structure.order < 2 && keeps_values(structure)) {
        constexpr double let_pass = 1.56;
        constexpr double of_exact_nodes = 2;  // where cells are too coarse
        CHECK(largest_growth(*space, work.sources) <= of_exact_nodes * let_pass);
        const auto by_queue = made(structure, work);
        by_queue->insert(std::span(work.sources));
        by_queue->grade({.schedule = GradationSchedule::queue});
        CHECK(largest_growth(*by_queue, work.sources) <= let_pass);
    }
}

}  // namespace controlspace::irregular_sources_test
