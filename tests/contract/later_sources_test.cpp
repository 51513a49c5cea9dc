// SPDX-License-Identifier: Apache-2.0
// Sources that come after gradation, where that is provided for: grading again gives the field of
// all sources at once.
#include <algorithm>
#include <catch2/catch.hpp>
#include <random>

#include "contract/structure_case.h"
#include "controlspace/measure/access_time.h"
#include "controlspace/metric/nonconformity.h"
#include "editable_space.h"

namespace controlspace::later_sources_test {
namespace {

using Batch = std::vector<PointSource>;

const Box domain{Point(-1, -1, -1), Point(1, 1, 1)};
constexpr GradationOptions queue{.schedule = GradationSchedule::queue};

// By the sources, and from node to node.
std::vector<GradationOptions> gradations(double g) {
    constexpr auto by_queue = GradationSchedule::queue;
    return {{.ratio = g},
            {.schedule = by_queue, .ratio = g},
            {.schedule = by_queue, .ratio = g, .neighbourhood = Neighbourhood::all}};
}

// Sources that neighbour each other in size and place only by chance: some fine, most coarser than
// what gradation makes of the fine ones, some in the same place, some on faces of leaves.
Batch scattered(int n, unsigned seed) {
    std::mt19937 engine(seed);
    const auto uniform = [&] { return static_cast<double>(engine()) / 4294967296.0; };
    Batch sources;
    for (int i = 0; i < n; ++i) {
        Point x(2 * uniform() - 1, 2 * uniform() - 1, 2 * uniform() - 1);
        if (i % 7 == 0) x[i % 3] = 0.25 * std::round(4 * x[i % 3]);
        if (i % 11 == 10) x = sources[static_cast<std::size_t>(i / 2)].position;
        const double share = uniform();
        sources.push_back({x, Metric::isotropic(0.05 + 0.8 * share * share)});
    }
    return sources;
}

Batch layered(int n, unsigned seed) {
    Batch sources = scattered(n, seed);
    for (std::size_t i = 0; i < sources.size(); ++i) {
        Metric& m = sources[i].metric;
        (i % 3 == 0 ? m.xx : i % 3 == 1 ? m.yy : m.zz) *= 0.25;
    }
    return sources;
}

SpaceOptions later() {
    return {.domain = domain, .kd_depth = 200, .finest_length = 0.1, .takes_later_sources = true};
}

std::vector<Metric> answers(const ControlSpace& space) {
    return answers(space, random_points(space.domain(), 3000, 77));
}

std::vector<Metric> node_metrics(const ControlSpace& space) {
    return control_nodes(space, Neighbourhood::faces).value().metrics;
}

std::unique_ptr<EditableSpace> all_at_once(const CatalogueEntry& structure,
                                           const std::vector<Batch>& batches,
                                           const GradationOptions& gradation) {
    auto space = editable(structure.make(later()));
    for (const Batch& batch : batches) space->insert(batch);
    space->grade(gradation);
    return space;
}

// Batch after batch, graded each time.
std::unique_ptr<EditableSpace> in_turn(const CatalogueEntry& structure,
                                       const std::vector<Batch>& batches,
                                       const GradationOptions& gradation) {
    auto space = editable(structure.make(later()));
    for (const Batch& batch : batches) {
        space->insert(batch);
        space->grade(gradation);
    }
    return space;
}

void require_same(const ControlSpace& a, const ControlSpace& b) {
    CHECK(answers(a) == answers(b));
    CHECK(node_metrics(a) == node_metrics(b));
}

bool does_not_overshoot(const CatalogueEntry& structure) {
    return keeps_node_values(structure) && structure.order < 2;
}

}  // namespace

// Leaves are cut, yet nothing gets smaller there: the nodes that hung on the leaf that is no more
// must grow.
STRUCTURE_CASE(keeps_node_values,
               "later sources that are coarser than the field cut leaves, and sizes grow") {
    const double g = GENERATE(1.1, 1.25, 1.6);
    const GradationOptions gradation = GENERATE_COPY(from_range(gradations(g)));
    Batch fine = scattered(6, 3);
    for (PointSource& source : fine) source.metric = Metric::isotropic(0.05);
    std::vector<Batch> batches{fine};
    for (unsigned seed = 1; seed <= 40; ++seed) {
        batches.push_back(scattered(2, seed));
        for (PointSource& source : batches.back()) {
            source.metric = Metric::isotropic(0.2 + source.metric.xx);
        }
    }
    CAPTURE(g);
    require_same(*in_turn(structure, batches, gradation),
                 *all_at_once(structure, batches, gradation));
}

STRUCTURE_CASE(stores_node_values,
               "what makes no difference is not followed, and what does is followed alone") {
    const Batch fine = scattered(100, 5);
    const Batch near = scattered(3, 6);
    const auto space = editable(structure.make(later()));
    space->insert(fine);
    CHECK_FALSE(space->grade(queue).visits.has_value());
    const std::vector<Metric> before = answers(*space);

    CHECK(space->grade(queue).visits == 0u);
    CHECK(space->insert({Point::Zero(), Metric::isotropic(1.8)}) == Insertion::already_met);
    if (structure.order < 2) {  // quadratic functions overshoot: some are wanted again
        CHECK(space->insert(fine).inserted == 0);
    }
    CHECK(space->grade(queue).visits == 0u);
    CHECK(answers(*space) == before);

    space->insert(near);
    const GradationReport report = space->grade(queue);
    const std::size_t nodes = space->footprint().control_nodes;
    CHECK(report.visits > 0u);
    CHECK(report.visits < nodes);
    // Never less than what is left, up to the steps of a lattice that positions round.
    const ControlNodes graded = space->control_nodes(Neighbourhood::faces);
    CHECK(report.largest_ratio_left * (1 + 1e-9) >=
          largest_gradation(graded.graph, graded.metrics, GradationLaw::cone));
    CHECK(report.largest_ratio_left <= 1.25);
}

STRUCTURE_CASE(keeps_node_values,
               "tensors, other laws, passes: all graded anew, with the bits of all at once") {
    const std::vector<Batch> batches{scattered(20, 7), layered(10, 8), scattered(10, 9)};
    const GradationOptions gradation =
        GENERATE(GradationOptions{}, queue,
                 GradationOptions{GradationLaw::mean_length, GradationSchedule::passes, 1.25});
    require_same(*in_turn(structure, batches, gradation),
                 *all_at_once(structure, batches, gradation));
}

STRUCTURE_CASE(keeps_node_values,
               "another neighbourhood grades what the sources request, not what was graded") {
    const std::vector<Batch> batches{scattered(100, 12)};
    const auto space =
        all_at_once(structure, batches,
                    {.schedule = GradationSchedule::queue, .neighbourhood = Neighbourhood::all});
    space->grade(queue);
    require_same(*space, *all_at_once(structure, batches, queue));
}

STRUCTURE_CASE(keeps_node_values,
               "another ratio grades what the sources request, not what was graded") {
    const std::vector<Batch> batches{scattered(100, 12)};
    const auto schedule = GENERATE(GradationSchedule::sources, GradationSchedule::queue);
    const auto space = all_at_once(structure, batches, {.schedule = schedule, .ratio = 1.1});
    space->grade({.schedule = schedule, .ratio = 1.5});
    require_same(*space, *all_at_once(structure, batches, {.schedule = schedule, .ratio = 1.5}));
}

// Quadratic functions overshoot, and cutting a leaf makes finer neighbours' vertices count.
STRUCTURE_CASE(does_not_overshoot,
               "between insertion and gradation: the source is met, and nothing grows") {
    const Batch fine = scattered(100, 13);
    const auto space = all_at_once(structure, {fine}, {});
    const std::vector<Metric> before = answers(*space);
    double worst = 0;
    for (const PointSource& source : scattered(30, 14)) {
        space->insert(source);
        worst = std::max(worst, sample_at(*space, source.position).xx / source.metric.xx);
    }
    CHECK(worst < 1.42);  // δ < 0.2
    if (structure.id == "K_V" || structure.id == "K_oV" || structure.id == "openvdb-bricks") return;
    const std::vector<Metric> after = answers(*space);
    double growth = 0;
    for (std::size_t i = 0; i < before.size(); ++i) {
        growth = std::max(growth, after[i].xx / before[i].xx);
    }
    CHECK(growth < 1 + 1e-12);
}

STRUCTURE_CASE(stores_node_values, "an assigned field is what is requested from then on") {
    const auto space = all_at_once(structure, {scattered(100, 15)}, {});
    std::vector<Metric> metrics = node_metrics(*space);
    std::fill(metrics.begin(), metrics.end(), Metric::isotropic(0.5));
    space->assign(metrics);
    space->insert({Point::Zero(), Metric::isotropic(0.2)});
    space->grade({});
    double largest = 0;
    for (const Metric& m : node_metrics(*space)) largest = std::max(largest, m.xx);
    CHECK(largest == 0.5);
    CHECK(sample_at(*space, Point::Zero()).xx < 0.28);
}

// Their field hangs on the order in which leaves take up sources.
STRUCTURE_CASE(keeps_sources_in_leaves, "structures that keep sources: close to all at once") {
    const std::vector<Batch> batches{scattered(150, 1), scattered(8, 11), scattered(60, 31)};
    const std::vector<Metric> once = answers(*all_at_once(structure, batches, {}));
    const std::vector<Metric> turns = answers(*in_turn(structure, batches, {}));
    double worst = 0;
    double sum = 0;
    for (std::size_t i = 0; i < once.size(); ++i) {
        const double delta = nonconformity(once[i], turns[i]);
        worst = std::max(worst, delta);
        sum += delta;
    }
    CHECK(worst < 0.25);
    CHECK(sum < 0.003 * static_cast<double>(once.size()));
}

}  // namespace controlspace::later_sources_test
