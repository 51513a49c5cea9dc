// SPDX-License-Identifier: Apache-2.0
// Domains of any aspect, and planes: boxes with no extent along one axis.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "contract/structure_case.h"
#include "controlspace/error.h"
#include "controlspace/measure/access_time.h"
#include "controlspace/measure/accuracy.h"
#include "controlspace/measure/reference.h"
#include "controlspace/measure/steepness.h"
#include "controlspace/metric/nonconformity.h"
#include "controlspace/space/control_space_file.h"
#include "editable_space.h"
#include "scratch_directory.h"

namespace controlspace::flat_domain_test {

using Catch::Matchers::Contains;

namespace {

constexpr double g = 1.25;

AdaptationGoal goal_of(const Work& work, double target) {
    return {.sources = work.sources, .continuous = nullptr, .ratio = g, .target = target};
}

// With the plane across another axis.
Work turned(Work work, int turns) {
    const auto turn = [turns](const Point& x) {
        return Point(x[turns % 3], x[(turns + 1) % 3], x[(turns + 2) % 3]);
    };
    work.domain = {turn(work.domain.low), turn(work.domain.high)};
    for (PointSource& source : work.sources) source.position = turn(source.position);
    return work;
}

bool is_octree(const CatalogueEntry& structure) {
    return structure.id.starts_with("K_o") && does_not_round(structure);
}

}  // namespace

STRUCTURE_CASE(does_not_round, "adapted on a plane, the target holds all over it") {
    constexpr double target = 0.1;
    const Work work = turned(flat_box(), GENERATE(0, 1, 2));
    const auto space = editable(structure.make(work.options()));
    const AdaptationReport report = space->adapt(goal_of(work, target));
    CHECK(report.met);
    double worst = 0;
    for (const Point& x : cell_centres(work.domain, 200)) {
        const Metric exact = Metric::isotropic(exact_length(work, x));
        worst = std::max(worst, nonconformity(sample_at(*space, x), exact));
    }
    CHECK(worst <= target);
    CHECK(worst > 0);
}

STRUCTURE_CASE(is_octree, "trees reach their target on a plane, as quadtrees") {
    const Work work = flat_box();
    const auto space = editable(structure.make(work.options()));
    CHECK(space->adapt(goal_of(work, 0.1)).met);
    const Footprint footprint = space->footprint();
    CHECK(footprint.cells > 1);
    // Each cut makes four of one.
    CHECK(footprint.tree_nodes - footprint.cells == (footprint.cells - 1) / 3);
    for (const Point& x : random_points(work.domain, 100, 3)) {
        const Box cell = space->cell_at(x).value();
        CHECK(cell.low.y() == 0.3);
        CHECK(cell.high.y() == 0.3);
        CHECK(cell.edges().x() < 2 * cell.edges().z());
        CHECK(cell.edges().z() < 2 * cell.edges().x());
    }
}

STRUCTURE_CASE(is_octree, "in thin boxes an octree has a few times the leaves of the kd-tree") {
    const Vector edges = GENERATE(Vector(1, 1, 0.001), Vector(100, 0.1, 0.1), Vector(0.01, 3, 1));
    const Work work = thin_box(edges);
    std::string of_kd = structure.id == "K_oLB" ? "K_L" : structure.id;
    std::erase(of_kd, 'o');
    const CatalogueEntry* kd = find_entry(structures(), of_kd);
    REQUIRE(kd != nullptr);
    CAPTURE(edges.transpose(), of_kd);
    constexpr double most = 8;  // leaves of a cut in three axes
    const auto cells = [&](const CatalogueEntry& entry, bool adapted) {
        auto space = editable(entry.make(work.options()));
        if (adapted) {
            CHECK(space->adapt(goal_of(work, 0.1)).met);
        } else {
            space->insert(work.sources);
            space->grade({.ratio = g});
        }
        return static_cast<double>(space->footprint().cells);
    };
    for (const bool adapted : {false, true}) {
        CHECK(cells(structure, adapted) <= most * cells(*kd, adapted));
    }
}

TEST_CASE("a balanced octree stays balanced in thin boxes and on planes") {
    const Work work = GENERATE(thin_box({1, 1, 0.001}), thin_box({20, 1, 3}), flat_box());
    const CatalogueEntry* balanced = find_entry(structures(), "K_oLB");
    REQUIRE(balanced != nullptr);
    SpaceOptions options = work.options();
    options.l_min = 0.5;
    const auto space = editable(balanced->make(options));
    space->insert(work.sources);
    double largest = 0;
    for (const Point& x : random_points(work.domain, 3000, 4)) {
        const Box cell = space->cell_at(x).value();
        for (int face = 0; face < 6; ++face) {
            const Axis a = face / 2;
            Point beyond = x;
            beyond[a] = face % 2 == 1 ? std::nextafter(cell.high[a], 1e9)
                                      : std::nextafter(cell.low[a], -1e9);
            if (!work.domain.contains(beyond)) continue;
            const Vector other = space->cell_at(beyond).value().edges();
            for (Axis b = 0; b < 3; ++b) {
                if (cell.edges()[b] > 0) largest = std::max(largest, other[b] / cell.edges()[b]);
            }
        }
    }
    CHECK(largest > 1.9);
    CHECK(largest < 2.1);
}

STRUCTURE_CASE(every_structure, "thin boxes: saved and loaded alike") {
    const ScratchDirectory scratch("thin");
    const Work work = thin_box(GENERATE(Vector(1, 1, 0.001), Vector(100, 0.1, 0.1)));
    const auto space = work.graded(structure);
    save_control_space(scratch / "field.ctrl", *space);
    const auto loaded = load_control_space(scratch / "field.ctrl", structures());
    const std::vector<Point> x = random_points(work.domain, 500, 1);
    CHECK(answers(*loaded, x) == answers(*space, x));
    CHECK(loaded->footprint().cells == space->footprint().cells);
}

STRUCTURE_CASE(every_structure,
               "sources off the plane are refused by their index, lines as domains") {
    Work work = flat_box();
    work.sources[7].position.y() = 0.3000001;
    const auto space = editable(structure.make(work.options()));
    CHECK_THROWS_WITH(space->insert(work.sources), Contains("7") && Contains("outside"));
    work.domain.high.x() = work.domain.low.x();
    CHECK_THROWS_WITH(structure.make(work.options()), Contains("no extent along two axes"));
}

TEST_CASE("grids of places on a plane are of one layer, and growth is found in it") {
    const Work work = flat_box();
    const std::vector<Point> x = cell_centres(work.domain, 20);
    CHECK(x.size() == 400);
    CHECK(std::ranges::all_of(x, [&](const Point& p) { return work.domain.contains(p); }));
    CHECK(cell_counts(work.domain, 20) == std::array{20, 1, 20});
    const auto exact =
        exact_reference(work.sources, g, Metric::isotropic(work.domain.half_diagonal()));
    const Steepness found = steepness(*exact, work.domain, work.sources, 1, 100000);
    CHECK(found.dir > 1.2);
    CHECK(found.dir < 1.2501);
}

}  // namespace controlspace::flat_domain_test
