// SPDX-License-Identifier: Apache-2.0
// What gradation must not do: make the field longer, or forget a source.
#include <Eigen/LU>
#include <catch2/catch.hpp>

#include "case_of_each.h"
#include "controlspace/measure/accuracy.h"
#include "controlspace/metric/intersection.h"
#include "controlspace/sources/sampled_surfaces.h"
#include "controlspace/space/catalogue.h"
#include "editable_space.h"

namespace controlspace::grading_test {
namespace {

const Box domain{Point::Constant(-1), Point::Constant(1)};

void check_no_longer(const std::vector<Metric>& after, const std::vector<Metric>& before) {
    REQUIRE(after.size() == before.size());
    double longest = 0;
    for (std::size_t i = 0; i < after.size(); ++i) {
        longest = std::max(longest, growth(after[i], before[i]));
    }
    CHECK(longest <= 1 + 1e-9);
}

// Lengths along some direction may grow where tensors are intersected without an order, volumes
// not.
void check_no_larger(const std::vector<Metric>& after, const std::vector<Metric>& before) {
    constexpr double gap = 6e-3;  // of the intersections
    for (std::size_t i = 0; i < after.size(); ++i) {
        CHECK(after[i].matrix().determinant() <= (1 + gap) * before[i].matrix().determinant());
    }
}

// Grades, with a ratio that is smaller or larger than that of the options.
void check_grading(EditableSpace& space, const CatalogueEntry& entry, bool isotropic,
                   double ratio) {
    std::vector<Point> x = cell_centres(domain, 17);
    const std::vector<Metric> before = answers(space, x);
    const ControlNodes nodes = space.control_nodes(Neighbourhood::faces);
    space.grade({.schedule = GradationSchedule::queue, .ratio = ratio});
    if (entry.has<MetricNodes>()) {
        check_no_longer(space.control_nodes(Neighbourhood::faces).metrics, nodes.metrics);
    }
    if (!entry.has<MetricNodes>() && !isotropic) {
        check_no_larger(answers(space, x), before);
    } else if (entry.order == 0 || (entry.order == 1 && isotropic)) {
        check_no_longer(answers(space, x), before);
    }
}

}  // namespace

CASE_OF_EACH(entry, all_trees(),
             "gradation from node to node makes no control node longer, nor what leaves and "
             "isotropic vertices answer",
             "[long]") {
    const bool isotropic = GENERATE(true, false);
    const auto sources = isotropic ? sample_sphere({.h = 0.05, .s_a = 2, .s_n = 1, .rho = 2})
                                   : sample_sphere({.h = 0.1, .s_a = 4, .s_n = 0.25, .rho = 2});
    for (const double ratio : {1.25, 1.1, 1.6}) {
        CAPTURE(isotropic, ratio);
        const auto space = editable(entry.make({.domain = domain}));
        space->insert(sources);
        check_grading(*space, entry, isotropic, ratio);
        check_grading(*space, entry, isotropic, ratio);
    }
}

CASE_OF_EACH(entry, all_trees(), "gradation makes what was adapted no longer", "[long]") {
    const bool isotropic = GENERATE(true, false);
    const auto sources = isotropic ? sample_sphere({.h = 0.1, .s_a = 2, .s_n = 1, .rho = 2})
                                   : sample_sphere({.h = 0.2, .s_a = 4, .s_n = 0.25, .rho = 2});
    CAPTURE(isotropic);
    const auto space = editable(entry.make({.domain = domain}));
    space->adapt({.sources = sources, .continuous = nullptr, .ratio = 1.25, .target = 0.2});
    check_grading(*space, entry, isotropic, 1.25);
}

CASE_OF_EACH(entry, anchored_catalogue(), "a lone source in a large leaf is kept by gradation") {
    const PointSource source{Point(0.31, -0.22, 0.13), Metric::isotropic(0.309)};
    const auto space = editable(entry.make({.domain = domain, .l_min = 2, .ratio = 10}));
    space->insert(source);
    space->grade({.ratio = 10});
    CHECK(sample_at(*space, source.position).xx == Approx(0.309));
    space->grade({.ratio = 10});
    CHECK(sample_at(*space, source.position).xx == Approx(0.309));
}

// Gradation builds again: once, with all sources that were met.
CASE_OF_EACH(entry, anchored_catalogue(),
             "later sources that were met are met after the next gradation") {
    const auto sources = sample_sphere({.h = 0.1, .s_a = 4, .s_n = 0.25, .rho = 2});
    const auto space = editable(entry.make({.domain = domain, .takes_later_sources = true}));
    space->insert(sources);
    space->grade({});
    std::vector<PointSource> met;
    for (const Point& x : cell_centres(domain, 4)) {
        const PointSource source{x, 1.02 * sample_at(*space, x)};
        if (space->insert(source) != Insertion::inserted) met.push_back(source);
    }
    CHECK(!met.empty());
    space->grade({});
    for (const PointSource& source : met) {
        CHECK(growth(sample_at(*space, source.position), source.metric) <= 1.02);
    }
}

}  // namespace controlspace::grading_test
