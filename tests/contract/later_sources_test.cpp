// SPDX-License-Identifier: Apache-2.0
// Sources that come after gradation, where that is provided for: grading again gives the field of
// all sources at once, to the bit.
#include <algorithm>
#include <catch2/catch.hpp>
#include <random>

#include "contract/structure_case.h"
#include "controlspace/error.h"
#include "controlspace/fields/analytic_field.h"
#include "controlspace/measure/access_time.h"
#include "controlspace/space/control_space_file.h"
#include "editable_space.h"
#include "scratch_directory.h"

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

Batch joined(const std::vector<Batch>& batches) {
    Batch all;
    for (const Batch& batch : batches) all.insert(all.end(), batch.begin(), batch.end());
    return all;
}

// In a structure that is for no later sources.
std::unique_ptr<EditableSpace> all_at_once(const CatalogueEntry& structure,
                                           const std::vector<Batch>& batches,
                                           const GradationOptions& gradation,
                                           SpaceOptions options = later()) {
    options.takes_later_sources = false;
    auto space = editable(structure.make(options));
    space->insert(joined(batches));
    space->grade(gradation);
    return space;
}

// Batch after batch, graded each time.
std::unique_ptr<EditableSpace> in_turn(const CatalogueEntry& structure,
                                       const std::vector<Batch>& batches,
                                       const GradationOptions& gradation,
                                       const SpaceOptions& options = later()) {
    auto space = editable(structure.make(options));
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
bool is_tree(const CatalogueEntry& structure) {
    return does_not_round(structure) && structure.has<SourceLeaves>();
}
// Of tensors these are compared with the field at 200 000 probes each time.
bool is_probed(const CatalogueEntry& structure) {
    return does_not_round(structure) && (structure.has<VoxelSize>() || is_direct(structure));
}
bool is_not_probed(const CatalogueEntry& structure) {
    return does_not_round(structure) && !is_probed(structure);
}
// Those that take longest are left out.
bool is_probed_soon(const CatalogueEntry& structure) {
    return is_probed(structure) && structure.order == 0;
}

AdaptationGoal goal(const Batch& sources, std::shared_ptr<const ControlSpace> continuous = {}) {
    return {.sources = sources,
            .continuous = std::move(continuous),
            .ratio = 1.3,
            .target = 0.4,
            .max_leaves = 800};
}

// A copy that a file holds.
std::unique_ptr<EditableSpace> through_file(const EditableSpace& space) {
    const ScratchDirectory scratch;
    save_control_space(scratch / "a.ctrl", space);
    return load_editable(scratch / "a.ctrl", structures());
}

// Adapted to some sources, then to those that come later, which a loaded copy does too.
void check_adapted(const CatalogueEntry& structure, const Batch& second, bool has_continuous) {
    const std::vector<Batch> batches{scattered(12, 1), second, scattered(3, 4)};
    std::shared_ptr<const ControlSpace> continuous;
    if (has_continuous) {
        const auto formula = [](const Point& x) {
            return Metric::isotropic(0.4 + 0.2 * x.squaredNorm());
        };
        continuous = function_field(formula, 0.4).field;
    }
    SpaceOptions options = later();
    const auto space = editable(structure.make(options));
    space->adapt(goal(batches[0], continuous));
    space->insert(batches[1]);
    space->grade({.ratio = 1.3});
    space->insert(batches[2]);
    const bool can_be_saved = !continuous;
    const auto loaded = can_be_saved ? through_file(*space) : nullptr;
    space->grade({.ratio = 1.3});
    options.takes_later_sources = false;
    const auto expected = editable(structure.make(options));
    const Batch all = joined(batches);
    expected->adapt(goal(all, continuous));
    require_same(*space, *expected);
    if (!loaded) return;
    loaded->grade({.ratio = 1.3});
    require_same(*loaded, *expected);
}

}  // namespace

STRUCTURE_CASE(does_not_round,
               "sources in many parts, graded after each: the field of all at once, to the bit") {
    const double g = GENERATE(1.1, 1.6);
    const GradationOptions gradation = GENERATE_COPY(from_range(gradations(g)));
    Batch fine = scattered(6, 3);
    for (PointSource& source : fine) source.metric = Metric::isotropic(0.05);
    std::vector<Batch> batches{fine};
    for (unsigned seed = 1; seed <= 8; ++seed) {
        batches.push_back(scattered(4, seed));
        for (PointSource& source : batches.back()) {
            source.metric = Metric::isotropic(0.2 + source.metric.xx);
        }
    }
    SpaceOptions options = later();
    options.vertices_in_turn = GENERATE(false, true);
    CAPTURE(g, options.vertices_in_turn);
    require_same(*in_turn(structure, batches, gradation, options),
                 *all_at_once(structure, batches, gradation, options));
}

STRUCTURE_CASE(does_not_round, "so are tensors, other laws, passes and columns of sources") {
    const std::vector<Batch> batches{scattered(12, 7), layered(6, 8), scattered(6, 9)};
    const GradationOptions gradation =
        GENERATE(GradationOptions{}, queue,
                 GradationOptions{GradationLaw::mean_length, GradationSchedule::passes, 1.25});
    const auto expected = all_at_once(structure, batches, gradation);
    require_same(*in_turn(structure, batches, gradation), *expected);
    const auto builder = structure.make(later());
    for (const Batch& batch : batches) {
        builder->insert(columns_of(batch));
        builder->grade(gradation);
    }
    CHECK(answers(*builder->build()) == answers(*expected));
}

STRUCTURE_CASE(does_not_round, "so are sources with ratios of their own") {
    std::vector<Batch> batches{scattered(30, 7), layered(15, 8), scattered(15, 9)};
    for (Batch& batch : batches) {
        for (std::size_t i = 0; i < batch.size(); i += 3)
            batch[i].growth = i % 2 == 0 ? 1.05 : 1.15;
    }
    require_same(*in_turn(structure, batches, {}), *all_at_once(structure, batches, {}));
}

STRUCTURE_CASE(does_not_round, "so are parts that were read before they were graded") {
    const std::vector<Batch> batches{scattered(30, 7), scattered(15, 9)};
    const auto space = editable(structure.make(later()));
    for (const Batch& batch : batches) {
        space->insert(batch);
        answers(*space);
    }
    space->grade({});
    require_same(*space, *all_at_once(structure, batches, {}));
}

STRUCTURE_CASE(does_not_round, "so is the field of another ratio or other neighbours") {
    const std::vector<Batch> batches{scattered(60, 12)};
    const auto schedule = GENERATE(GradationSchedule::sources, GradationSchedule::queue);
    const auto space = in_turn(structure, batches, {.schedule = schedule, .ratio = 1.1});
    const GradationOptions other{.schedule = schedule, .ratio = 1.2};
    space->grade(other);
    require_same(*space, *all_at_once(structure, batches, other));
    const GradationOptions to_all{
        .schedule = schedule, .ratio = 1.2, .neighbourhood = Neighbourhood::all};
    space->grade(to_all);
    space->grade(other);
    require_same(*space, *all_at_once(structure, batches, other));
}

STRUCTURE_CASE(does_not_round, "graded again without another source, nothing is done") {
    const auto space = in_turn(structure, {scattered(30, 5)}, queue);
    const std::vector<Metric> before = answers(*space);
    CHECK(space->grade(queue).operations == 0);
    CHECK(answers(*space) == before);
}

STRUCTURE_CASE(does_not_round, "what was adapted is adapted to all sources, to the same goal") {
    check_adapted(structure, scattered(3, 2), GENERATE(false, true));
}
STRUCTURE_CASE(is_not_probed, "so is what was adapted before tensors came") {
    check_adapted(structure, layered(3, 3), false);
}
STRUCTURE_CASE(is_probed_soon, "so is what was adapted before tensors came, by probes", "[long]") {
    check_adapted(structure, layered(3, 3), false);
}

STRUCTURE_CASE(stores_node_values, "sources after an assigned field: those of all at once, too") {
    const std::vector<Batch> batches{scattered(20, 21), scattered(20, 22)};
    const auto assigned = [&] {
        auto space = all_at_once(structure, {scattered(60, 15)}, {});
        auto later_one = in_turn(structure, {scattered(60, 15)}, {});
        std::vector<Metric> metrics = node_metrics(*space);
        for (std::size_t i = 0; i < metrics.size(); i += 3) metrics[i] = Metric::isotropic(0.3);
        later_one->assign(metrics);
        return later_one;
    };
    const auto turns = assigned();
    turns->insert(batches[0]);
    turns->grade(queue);
    turns->insert(batches[1]);
    const auto loaded = through_file(*turns);
    turns->grade(queue);
    const auto once = assigned();
    once->insert(joined(batches));
    once->grade(queue);
    require_same(*turns, *once);
    loaded->grade(queue);
    require_same(*loaded, *once);
    CHECK_THROWS_AS(turns->insert({Point::Zero(), Metric::isotropic(0.2), 1.1}), InputError);
}

// Otherwise a limit of time would leave half a field.
STRUCTURE_CASE(is_tree, "gradation that is stopped leaves the field as it was") {
    int stop = 0;
    SpaceOptions options = later();
    options.growth.stop = &stop;
    const std::vector<Batch> batches{scattered(30, 1), scattered(10, 2)};
    const auto space = in_turn(structure, {batches[0]}, {}, options);
    space->insert(batches[1]);
    const std::vector<Metric> before = answers(*space);
    stop = 1;
    CHECK_THROWS_AS(space->grade({}), GrowthStopped);
    CHECK(answers(*space) == before);
    stop = 0;
    space->grade({});
    require_same(*space, *all_at_once(structure, batches, {}));
}

STRUCTURE_CASE(stores_a_field, "the sources that are kept count as memory") {
    const std::vector<Batch> batches{scattered(200, 1)};
    const auto bytes = [](const auto& space) { return space->footprint().bytes_auxiliary; };
    CHECK(bytes(in_turn(structure, batches, {})) >=
          bytes(all_at_once(structure, batches, {})) + 200 * 32);
}

// Quadratic functions overshoot, and cutting a leaf makes finer neighbours' vertices count.
STRUCTURE_CASE(does_not_overshoot,
               "between insertion and gradation: the source is met, and nothing grows") {
    const Batch fine = scattered(100, 13);
    const auto space = in_turn(structure, {fine}, {});
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
    const auto space = in_turn(structure, {scattered(100, 15)}, {});
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

}  // namespace controlspace::later_sources_test
