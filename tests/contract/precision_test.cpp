// SPDX-License-Identifier: Apache-2.0
// Structures in each precision: what is stored, what is read back, and what an adapted one
// promises.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <utility>

#include "contract/structure_case.h"
#include "controlspace/error.h"
#include "controlspace/measure/access_time.h"
#include "controlspace/metric/nonconformity.h"
#include "controlspace/space/control_nodes.h"
#include "controlspace/space/control_space_file.h"

namespace controlspace::precision_test {

using Catch::Matchers::Contains;

namespace {

// The largest factor, at least 1, between lengths at `x`.
double largest_factor(const ControlSpace& a, const ControlSpace& b, const std::vector<Point>& x) {
    double most = 1;
    for (const Point& p : x) most = std::max(most, largest_ratio(a.metric_at(p), b.metric_at(p)));
    return most;
}

// Half a step, as a factor, of 255 equal ratios.
double half_step(const ControlSpace& space) {
    const auto nodes = control_nodes(space, Neighbourhood::faces).value().metrics;
    const auto [shortest, longest] = std::ranges::minmax(nodes, {}, &Metric::xx);
    return std::pow(longest.xx / shortest.xx, 1.0 / 510);
}

bool is_linear(const CatalogueEntry& structure) {
    return has_compact_form(structure) && structure.order < 2;
}
// Bricks have codes of their own, whose steps are mostly finer.
bool has_own_codes(const CatalogueEntry& structure) { return structure.id == "openvdb-bricks"; }
bool is_tree(const CatalogueEntry& structure) {
    return is_linear(structure) && structure.has<SourceLeaves>();
}
bool is_plain_grid(const CatalogueEntry& structure) { return structure.id.starts_with("uniform"); }
bool is_grid(const CatalogueEntry& structure) {
    return has_compact_form(structure) && structure.has<VoxelSize>();
}

}  // namespace

STRUCTURE_CASE(is_linear, "doubles give the same bits, floats and codes what their steps allow") {
    const Work work = GENERATE(isotropic_sphere(), anisotropic_sphere(), oblong_box(), flat_box());
    CAPTURE(work.name);
    const auto space = work.graded(structure);
    const std::vector<Point> x = random_points(work.domain, 2000, 5);
    const std::vector<Metric> exact = answers(*space, x);
    CHECK(answers(*space->compact(Precision::doubles), x) == exact);
    const double in_floats = largest_factor(*space->compact(Precision::floats), *space, x);
    CHECK(in_floats > 1);
    CHECK(in_floats <= (work.isotropic() ? 1 + 6.1e-8 : 1 + 1e-5));
    if (!work.isotropic()) return;
    const double in_16_bits = largest_factor(*space->compact(Precision::log16), *space, x);
    CHECK(in_16_bits > 1 + (has_own_codes(structure) ? 2e-6 : 2e-5));
    CHECK(in_16_bits <= std::sqrt(1.0002) * (1 + 1.3e-7));
    const double in_8_bits = largest_factor(*space->compact(Precision::log8), *space, x);
    CHECK(in_8_bits > std::sqrt(std::sqrt(half_step(*space))));
    CHECK(in_8_bits <= half_step(*space) * (1 + 1e-12));
    if (has_own_codes(structure)) return;
    // Both ends are exact.
    const auto ends = [](const ControlSpace& s) {
        const auto nodes = control_nodes(s, Neighbourhood::faces).value().metrics;
        const auto [shortest, longest] = std::ranges::minmax(nodes, {}, &Metric::xx);
        return std::pair(shortest.xx, longest.xx);
    };
    CHECK(ends(*space->compact(Precision::log8)) == ends(*space));
}

STRUCTURE_CASE(is_grid,
               "of lengths a grid stores one number a node, in fewer bytes where fewer are asked") {
    const Work work = oblong_box();
    const auto space = work.graded(structure);
    const bool is_flat_array = structure.id.starts_with("uniform");
    const auto payload = [&](Precision precision) {
        const Footprint f = space->compact(precision)->footprint();
        return static_cast<double>(f.bytes_payload);
    };
    const double in_doubles = payload(Precision::doubles);
    const auto nodes = static_cast<double>(space->footprint().control_nodes);
    CHECK(6 * in_doubles == static_cast<double>(space->footprint().bytes_payload));
    if (is_flat_array) CHECK(in_doubles == 8 * nodes);
    constexpr double table = 256 * sizeof(double);
    CHECK(payload(Precision::floats) == in_doubles / 2);
    CHECK(payload(Precision::log16) <= in_doubles / 4 + table);
    CHECK(payload(Precision::log8) == in_doubles / 8 + table);
    // What could be asked of it is the same.
    const auto in_floats = space->compact(Precision::floats);
    CHECK(in_floats->footprint().cells == space->footprint().cells);
    CHECK(in_floats->cell_at(work.domain.centre()) == space->cell_at(work.domain.centre()));
}

STRUCTURE_CASE(is_linear, "what is read back keeps the target, in every precision") {
    const Work work = GENERATE(isotropic_sphere(), oblong_box(), flat_box());
    const auto precision =
        GENERATE(Precision::doubles, Precision::floats, Precision::log16, Precision::log8);
    constexpr double target = 0.05;
    CAPTURE(work.name, static_cast<int>(precision));
    const auto space = editable(structure.make(work.options()));
    const AdaptationReport report = space->adapt(
        {.sources = work.sources, .continuous = nullptr, .target = target, .precision = precision});
    CHECK(report.met);
    CHECK(report.is_bound);
    CHECK(report.reached <= target);
    const auto built = space->compact(precision);
    std::vector<Point> x = random_points(work.domain, 5'000, 3);
    for (const PointSource& s : work.sources) x.push_back(s.position);
    double worst = 0;
    for (const Point& p : x) {
        worst = std::max(
            worst, nonconformity(built->metric_at(p), Metric::isotropic(exact_length(work, p))));
    }
    CHECK(worst <= report.reached * (1 + 1e-9));
    // Where rounding is large, it was made room for.
    if (precision == Precision::log8) {
        double in_doubles = 0;
        const auto unrounded = space->compact(Precision::doubles);
        for (const Point& p : x) {
            in_doubles = std::max(
                in_doubles,
                nonconformity(unrounded->metric_at(p), Metric::isotropic(exact_length(work, p))));
        }
        const double room = largest_factor_within(target) / half_step(*unrounded);
        CHECK(in_doubles <= nonconformity_of_factor(room) * (1 + 1e-9));
    }
}

STRUCTURE_CASE(is_linear, "what is stopped at once says so, in every precision") {
    const Work work = isotropic_sphere();
    const auto precision =
        GENERATE(Precision::doubles, Precision::floats, Precision::log16, Precision::log8);
    SpaceOptions options = work.options();
    options.growth.deadline = GrowthLimit::Clock::time_point::min();
    const auto space = editable(structure.make(options));
    const AdaptationReport report = space->adapt(
        {.sources = work.sources, .continuous = nullptr, .target = 0.05, .precision = precision});
    CHECK_FALSE(report.met);
    CHECK(report.stop == GrowthStop::time);
    CHECK(report.reached > 0.05);
    CHECK_FALSE(report.shortfall.empty());
}

STRUCTURE_CASE(every_structure, "a number that names no precision or rule is refused") {
    const Work work = isotropic_sphere();
    AdaptationGoal goal{.sources = work.sources, .continuous = nullptr, .target = 0.05};
    for (const int number : {-1, 4, 255}) {
        CAPTURE(number);
        const auto space = structure.make(work.options());
        const auto precision = static_cast<Precision>(number);
        CHECK_THROWS_AS(space->build({.precision = precision}), InputError);
        AdaptationGoal wrong = goal;
        wrong.precision = precision;
        CHECK_THROWS_AS(space->adapt(wrong), InputError);
        wrong = goal;
        wrong.intersection = static_cast<IntersectionRule>(number);
        CHECK_THROWS_AS(space->adapt(wrong), InputError);
    }
}

bool is_quadratic(const CatalogueEntry& structure) {
    return has_compact_form(structure) && structure.order == 2;
}

STRUCTURE_CASE(is_quadratic, "codes make room for weights beyond 1, too") {
    const Work work = isotropic_sphere();
    constexpr double target = 0.05;
    const auto space = editable(structure.make(work.options()));
    const AdaptationReport report = space->adapt({.sources = work.sources,
                                                  .continuous = nullptr,
                                                  .target = target,
                                                  .precision = Precision::log8});
    CHECK(report.met);
    const auto built = space->compact(Precision::log8);
    const auto unrounded = space->compact(Precision::doubles);
    const std::vector<Point> x = random_points(work.domain, 5'000, 3);
    const double rounded = largest_factor(*built, *unrounded, x);
    CHECK(rounded <= std::pow(half_step(*unrounded), 2) * (1 + 1e-12));
    double worst = 0;
    for (const Point& p : x) {
        worst = std::max(
            worst, nonconformity(built->metric_at(p), Metric::isotropic(exact_length(work, p))));
    }
    CHECK(worst <= target);
}

STRUCTURE_CASE(is_tree, "codes that take more than a third of what a target allows are refused") {
    const Work work = oblong_box();
    const auto adapt = [&](double target, Precision precision) {
        return editable(structure.make(work.options()))
            ->adapt({.sources = work.sources,
                     .continuous = nullptr,
                     .target = target,
                     .precision = precision,
                     .max_leaves = 200});
    };
    CHECK_THROWS_WITH(adapt(1e-4, Precision::log8),
                      Contains("8 bits") && Contains("a third") && Contains("16 bits"));
    CHECK_NOTHROW(adapt(1e-4, Precision::log16));
    CHECK_THROWS_AS(adapt(1e-8, Precision::log16), InputError);
}

STRUCTURE_CASE(is_grid, "voxels chosen for a target keep it, and much larger ones do not") {
    const Work work = GENERATE(isotropic_sphere(), oblong_box(), flat_box());
    CAPTURE(work.name);
    constexpr double target = 0.1;
    const auto adapted = [&](double voxel) {
        SpaceOptions options = work.options();
        options.voxel = voxel;
        auto space = editable(structure.make(options));
        const AdaptationReport report =
            space->adapt({.sources = work.sources, .continuous = nullptr, .target = target});
        return std::pair(std::move(space), report);
    };
    const auto [space, report] = adapted(0);
    CHECK(report.met);
    CHECK(report.is_bound);
    const double voxel = recipe_of(space->built())->options.voxel;
    const std::vector<Point> x = random_points(work.domain, 2000, 9);
    const auto [given, again] = adapted(voxel);
    CHECK(again.met);
    CHECK(answers(*given, x) == answers(*space, x));
    const auto [coarse, missed] = adapted(1.6 * voxel);
    CHECK_FALSE(missed.is_bound);
    CHECK(coarse->footprint().cells < space->footprint().cells);
    // It can be chosen anew for another target.
    CHECK(space->adapt({.sources = work.sources, .continuous = nullptr, .target = 4 * target}).met);
    CHECK(recipe_of(space->built())->options.voxel > 1.2 * voxel);
}

STRUCTURE_CASE(is_plain_grid, "of tensors voxels are chosen by probes", "[long]") {
    const Work work = anisotropic_sphere();
    constexpr double target = 0.5;
    const auto space = editable(structure.make(work.options()));
    const AdaptationReport report =
        space->adapt({.sources = work.sources, .continuous = nullptr, .target = target});
    CHECK(report.met);
    CHECK_FALSE(report.is_bound);
    const auto exact = structures_that(is_direct).front().make(work.options());
    exact->insert(work.sources);
    exact->grade({});
    const auto field = exact->build();
    double worst = 0;
    for (const Point& p : random_points(work.domain, 2000, 9)) {
        worst =
            std::max(worst, directional_nonconformity(sample_at(*space, p), field->metric_at(p)));
    }
    CHECK(worst <= target);
    CHECK(worst > 0.1 * target);
}

STRUCTURE_CASE(is_grid,
               "a target that no grid within the memory keeps is missed, and the row says why") {
    const Work work = isotropic_sphere();
    SpaceOptions options = work.options();
    options.max_bytes = 3'000'000;
    const auto space = editable(structure.make(options));
    const AdaptationReport report =
        space->adapt({.sources = work.sources, .continuous = nullptr, .target = 1e-3});
    CHECK_FALSE(report.met);
    CHECK_THAT(report.shortfall, Contains("memory"));
    CHECK(space->footprint().bytes_total() <= options.max_bytes);
}

}  // namespace controlspace::precision_test
