// SPDX-License-Identifier: Apache-2.0
// Small random scenes over the whole catalogue, judged by sums in long double. CONTROLSPACE_SCENES
// is the number of scenes for each structure (20 unless it is set), CONTROLSPACE_FIRST_SCENE the
// seed of the first.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cstdlib>
#include <limits>

#include "contract/structure_case.h"
#include "controlspace/error.h"
#include "controlspace/measure/access_time.h"
#include "controlspace/metric/intersection.h"
#include "controlspace/metric/nonconformity.h"
#include "controlspace/space/control_space_file.h"
#include "scenes/oracle.h"
#include "scenes/scene.h"
#include "scratch_directory.h"

namespace controlspace::scenes_test {
namespace {

std::uint64_t number_from(const char* variable, std::uint64_t otherwise) {
    const char* text = std::getenv(variable);
    return text == nullptr ? otherwise : std::strtoull(text, nullptr, 10);
}

/// Calls check(scene, places, seed) for each seed.
template <class Check>
void for_each_scene(Check&& check) {
    const std::uint64_t first = number_from("CONTROLSPACE_FIRST_SCENE", 1);
    const std::uint64_t count = number_from("CONTROLSPACE_SCENES", 20);
    for (std::uint64_t seed = first; seed < first + count; ++seed) {
        const Scene scene = random_scene(seed);
        CAPTURE(seed, scene.name);
        check(scene, places_in(scene, seed), seed);
    }
}

std::unique_ptr<EditableSpace> inserted(const CatalogueEntry& structure, const Scene& scene) {
    auto space = editable(structure.make(scene.options));
    space->insert(std::span(scene.sources));
    return space;
}

// Floats, and rounding of metrics of 1e4.
double rounding(const CatalogueEntry& structure) { return does_not_round(structure) ? 1e-7 : 1e-4; }

// The greatest excess of an answer over M_max.
Real excess_over_largest(const std::vector<Metric>& m, const Scene& scene) {
    const Metric largest = largest_metric(scene.options);
    Real most = 0;
    for (const Metric& metric : m) most = std::max(most, oracle_excess(metric, largest));
    return most;
}

// How much a source's cone at `x` may be exceeded by what is linear between places of the cell of
// `x`, each of them within the cone: its factor is convex, so that it is largest at corners.
Real allowed_excess(const ControlSpace& space, const PointSource& source, double g, const Point& x,
                    Real at_x) {
    const std::optional<Box> cell = space.cell_at(x);
    if (!cell) return 1;
    Real most = at_x;
    for (int c = 0; c < 8; ++c) {
        const Point corner((c & 1 ? cell->high : cell->low).x(),
                           (c & 2 ? cell->high : cell->low).y(),
                           (c & 4 ? cell->high : cell->low).z());
        most = std::max(most, oracle_factor(source, g, corner));
    }
    return most / at_x;
}

// Answers of leaves with one metric, or linear between several.
bool has_bounds(const CatalogueEntry& structure) {
    return keeps_values(structure) && structure.order < 2;
}

void check_bounds(const CatalogueEntry& structure, const ControlSpace& space, const Scene& scene,
                  const std::vector<Point>& x) {
    const std::vector<Metric> m = answers(space, x);
    // Tensors in turn leave cones out that would shorten nothing by more than this (ConeField).
    const bool in_turn =
        scene.options.intersection == IntersectionRule::in_turn && !scene.is_isotropic();
    const double tolerance = in_turn ? 0.01 : rounding(structure);
    for (std::size_t i = 0; i < x.size(); ++i) {
        CAPTURE(i, x[i].transpose(), to_string(m[i]));
        REQUIRE(oracle_is_positive_definite(m[i]));
        if (!has_bounds(structure)) continue;
        for (const PointSource& source : scene.sources) {
            const Real factor = oracle_factor(source, scene.options.ratio, x[i]);
            const Metric cone = static_cast<double>(factor) * source.metric;
            const Real allowed = allowed_excess(space, source, scene.options.ratio, x[i], factor);
            const Real excess = oracle_excess(m[i], cone);
            if (excess > allowed * (1 + tolerance)) {
                CAPTURE(source.position.transpose(), to_string(source.metric));
                CHECK(static_cast<double>(excess) <= static_cast<double>(allowed));
            }
        }
    }
}

double isotropic_delta(Real a, Real b) {
    const Real k = a / b;
    return static_cast<double>(std::sqrt(Real{3}) * (k + 1 / k - 2));
}

// Adapted trees of isotropic sources that promise a bound.
bool is_proved(const CatalogueEntry& structure) {
    return does_not_round(structure) && structure.has<SourceLeaves>() && structure.order < 2;
}

// Trees, which are cut where they depart from the field.
bool is_tree(const CatalogueEntry& structure) { return structure.id.starts_with("K_"); }
bool is_quadratic(const CatalogueEntry& structure) { return structure.order == 2; }
bool is_exact(const CatalogueEntry& structure) { return is_direct(structure); }

}  // namespace

STRUCTURE_CASE(every_structure, "inserted scenes: positive definite, within M_max, sources met") {
    for_each_scene([&](const Scene& scene, const auto& x, std::uint64_t) {
        const auto space = inserted(structure, scene);
        const std::vector<Metric> m = answers(*space, x);
        REQUIRE(std::ranges::all_of(m, oracle_is_positive_definite));
        if (!has_bounds(structure)) return;
        CHECK(static_cast<double>(excess_over_largest(m, scene)) <= 1 + rounding(structure));
        for (const PointSource& source : scene.sources) {
            const Metric held = sample_at(*space, source.position);
            CAPTURE(source.position.transpose(), to_string(held), to_string(source.metric));
            CHECK(nonconformity(held, intersection(held, source.metric)) <=
                  scene.options.tolerance * (1 + rounding(structure)) + rounding(structure));
        }
    });
}

STRUCTURE_CASE(every_structure, "scenes graded by the sources are within all cones") {
    for_each_scene([&](const Scene& scene, const auto& x, std::uint64_t) {
        const auto space = inserted(structure, scene);
        space->grade(scene.gradation());
        check_bounds(structure, *space, scene, x);
    });
}

STRUCTURE_CASE(every_structure,
               "outside its domain a scene answers as at the nearest place of it") {
    for_each_scene([&](const Scene& scene, const auto& x, std::uint64_t seed) {
        const auto space = inserted(structure, scene);
        space->grade(scene.gradation());
        // Off a flat domain too, by less and by more than the edges of its cells.
        const Box& domain = scene.options.domain;
        const double reach = domain.edges().maxCoeff() * (seed % 2 == 0 ? 1e-3 : 2);
        const Vector beyond = Vector::Constant(reach);
        auto outside = random_points({domain.low - beyond, domain.high + beyond}, 100, seed);
        for (std::size_t i = 0; i < x.size(); i += 7) {
            outside.push_back(x[i] + (i % 2 == 0 ? beyond : -beyond));
        }
        for (const Point& place : outside) {
            const Point nearest = place.cwiseMax(domain.low).cwiseMin(domain.high);
            CAPTURE(place.transpose(), nearest.transpose());
            REQUIRE(sample_at(*space, place) == sample_at(*space, nearest));
        }
    });
}

STRUCTURE_CASE(keeps_node_values,
               "scenes graded from node to node: nothing is longer, and the ratio holds") {
    for_each_scene([&](const Scene& scene, const auto& x, std::uint64_t) {
        if (scene.has_own_ratios()) return;
        const GradationOptions& options = scene.from_node_to_node;
        const auto space = inserted(structure, scene);
        const auto before = space->control_nodes(Neighbourhood::faces).metrics;
        const std::vector<Metric> answered = answers(*space, x);
        const GradationReport report = space->grade(options);
        const auto after = space->control_nodes(Neighbourhood::faces).metrics;
        REQUIRE(after.size() == before.size());
        for (std::size_t i = 0; i < after.size(); ++i) {
            CAPTURE(i, to_string(before[i]), to_string(after[i]));
            CHECK(static_cast<double>(oracle_excess(after[i], before[i])) <=
                  1 + rounding(structure));
        }
        if (is_direct(structure)) return;
        CHECK(report.largest_ratio_left <= options.ratio * (1 + 1e-4));
        for (const auto neighbourhood : {Neighbourhood::faces, Neighbourhood::all}) {
            const ControlNodes nodes = space->control_nodes(neighbourhood);
            CHECK(space->largest_gradation(neighbourhood, options.law) ==
                  largest_gradation(nodes.graph, nodes.metrics, options.law));
        }
        // Quadratic functions undershoot where a neighbour is far larger, which gradation ends; and
        // blends of smaller tensors are smaller as matrices, not always along each direction.
        if (structure.order == 2 || (structure.order == 1 && !scene.is_isotropic())) return;
        const std::vector<Metric> answered_after = answers(*space, x);
        for (std::size_t i = 0; i < x.size(); ++i) {
            CAPTURE(x[i].transpose());
            CHECK(is_within(answered_after[i], 1 + rounding(structure), answered[i]));
        }
    });
}

STRUCTURE_CASE(is_proved, "adapted scenes of isotropic sources keep the δ that they report") {
    for_each_scene([&](Scene scene, const auto& x, std::uint64_t) {
        if (!scene.is_isotropic()) return;
        scene.options.octree_depth = 6;
        scene.options.kd_depth = 18;
        const auto space = editable(structure.make(scene.options));
        const AdaptationReport report = space->adapt({.sources = scene.sources,
                                                      .continuous = nullptr,
                                                      .ratio = scene.options.ratio,
                                                      .target = 0.1});
        CAPTURE(report.reached, report.met, report.is_bound);
        CHECK(report.met == (report.reached <= 0.1));
        if (!report.is_bound) return;
        const double largest = largest_metric(scene.options).xx;
        for (const Point& p : x) {
            const double held = sample_at(*space, p).xx;
            const Real exact = oracle_length(scene.sources, scene.options.ratio, largest, p);
            CAPTURE(p.transpose(), held, static_cast<double>(exact));
            REQUIRE(isotropic_delta(held, exact) <= report.reached * (1 + 1e-9) + 1e-12);
        }
    });
}

STRUCTURE_CASE(every_structure,
               "scenes saved, loaded and compact answer the same bits, and after a later source") {
    const ScratchDirectory scratch("scenes");
    for_each_scene([&](const Scene& scene, const auto& x, std::uint64_t seed) {
        const auto space = inserted(structure, scene);
        if (seed % 2 == 0) space->grade(scene.gradation());
        save_control_space(scratch / "field.ctrl", *space);
        const auto loaded = load_editable(scratch / "field.ctrl", structures());
        const std::vector<Metric> m = answers(*space, x);
        CHECK(answers(*loaded, x) == m);
        CHECK(answers(*load_control_space(scratch / "field.ctrl", structures()), x) == m);
        CHECK(loaded->footprint().cells == space->footprint().cells);
        CHECK(loaded->footprint().control_nodes == space->footprint().control_nodes);
        CHECK(loaded->footprint().depth == space->footprint().depth);
        CHECK(loaded->footprint().bytes_total() <= space->footprint().bytes_total());
        save_control_space(scratch / "again.ctrl", *loaded);
        CHECK(file_text(scratch / "again.ctrl") == file_text(scratch / "field.ctrl"));
        if (has_compact_form(structure))
            CHECK(answers(*space->compact(Precision::doubles), x) == m);
        std::vector<double> lengths(x.size());
        space->built().sample_lengths(x, lengths);
        for (std::size_t i = 0; i < x.size(); ++i) {
            if (is_isotropic(m[i])) CHECK(lengths[i] == m[i].xx);
        }

        // K_V that was never graded inserts tensors into leaves, and once loaded into vertices.
        if (seed % 2 == 0) {
            const PointSource later{x.front(), 0.5 * scene.sources.front().metric};
            CHECK(loaded->insert(later) == space->insert(later));
        }
        loaded->grade(scene.gradation());
        space->grade(scene.gradation());
        CHECK(answers(*loaded, x) == answers(*space, x));
    });
}

STRUCTURE_CASE(does_not_round, "scenes whose sources come in three parts end as those at once") {
    for_each_scene([&](Scene scene, const auto& x, std::uint64_t seed) {
        // By the sources; or from node to node, where sources have no ratios of their own.
        const GradationOptions gradation =
            seed % 2 == 0 || scene.has_own_ratios() ? scene.gradation() : scene.from_node_to_node;
        const auto at_once = inserted(structure, scene);
        at_once->grade(gradation);
        scene.options.takes_later_sources = true;
        const auto in_parts = editable(structure.make(scene.options));
        const std::span<const PointSource> all(scene.sources);
        const std::size_t third = all.size() / 3;
        for (const auto part :
             {all.first(third), all.subspan(third, third), all.subspan(2 * third)}) {
            in_parts->insert(part);
            in_parts->grade(gradation);
        }
        CHECK(answers(*in_parts, x) == answers(*at_once, x));
        CHECK(in_parts->control_nodes(Neighbourhood::faces).metrics ==
              at_once->control_nodes(Neighbourhood::faces).metrics);
    });
}

STRUCTURE_CASE(every_structure,
               "cells of scenes contain the places that they answer for, and lie in the domain") {
    for_each_scene([&](const Scene& scene, const auto& x, std::uint64_t) {
        const auto space = inserted(structure, scene);
        const Box& domain = scene.options.domain;
        const double rounding = 1e-12 * std::max(domain.edges().maxCoeff(), domain.high.norm());
        for (const Point& p : x) {
            const std::optional<Box> cell = space->cell_at(p);
            REQUIRE(cell);
            CAPTURE(p.transpose(), cell->low.transpose(), cell->high.transpose());
            REQUIRE(cell->contains(p));
            REQUIRE((cell->low.array() >= domain.low.array() - rounding).all());
            REQUIRE((cell->high.array() <= domain.high.array() + rounding).all());
            // Edges of no length are those of a flat domain alone.
            REQUIRE(((cell->edges().array() > 0) == (domain.edges().array() > 0)).all());
        }
    });
}

STRUCTURE_CASE(every_structure, "scenes refuse lengths that they cannot hold") {
    for_each_scene([&](Scene scene, auto x, std::uint64_t) {
        constexpr double tiny = 1e-42;  // below the range of floats
        scene.options.domain.low *= tiny;
        scene.options.domain.high *= tiny;
        scene.options.finest_length *= tiny;
        scene.options.voxel *= tiny;
        if (scene.options.h_max < largest_magnitude) scene.options.h_max *= tiny;
        for (PointSource& source : scene.sources) {
            source.position *= tiny;
            source.metric = tiny * source.metric;
        }
        for (Point& p : x) p *= tiny;
        std::unique_ptr<EditableSpace> space;
        try {
            space = inserted(structure, scene);
        } catch (const InputError&) {
            CHECK(is_rounding(structure));
            return;
        }
        REQUIRE(std::ranges::all_of(answers(*space, x), oracle_is_positive_definite));
    });
}

STRUCTURE_CASE(is_quadratic, "graded scenes are within the cones of leaves' own metrics") {
    for_each_scene([&](const Scene& scene, const auto& x, std::uint64_t) {
        if (!scene.is_isotropic()) return;
        const auto space = inserted(structure, scene);
        GradationOptions gradation = scene.gradation();
        gradation.ratio = 1 + (gradation.ratio - 1) / 4;
        space->grade(gradation);
        double steepest = gradation.ratio;
        for (const PointSource& source : scene.sources) {
            steepest = std::max(steepest, source.growth);
        }
        for (const Point& p : x) {
            const Point centre = space->cell_at(p)->centre();
            const PointSource own{centre, sample_at(*space, centre)};
            const double allowed =
                static_cast<double>(oracle_factor(own, steepest, p)) * own.metric.xx;
            CAPTURE(p.transpose(), centre.transpose());
            REQUIRE(sample_at(*space, p).xx <= allowed * (1 + rounding(structure)));
        }
    });
}

STRUCTURE_CASE(keeps_sources_in_leaves, "scenes of isotropic sources get no longer by gradation") {
    for_each_scene([&](const Scene& scene, const auto& x, std::uint64_t) {
        if (!scene.is_isotropic()) return;
        const auto space = inserted(structure, scene);
        const std::vector<Metric> before = answers(*space, x);
        space->grade(scene.gradation());
        const std::vector<Metric> after = answers(*space, x);
        for (std::size_t i = 0; i < x.size(); ++i) {
            CAPTURE(x[i].transpose());
            REQUIRE(after[i].xx <= before[i].xx * (1 + rounding(structure)));
        }
    });
}

STRUCTURE_CASE(is_tree, "adapted scenes that met their target are near the field") {
    constexpr double target = 0.1;
    constexpr double most = target * (1 + 1e-9);
    for_each_scene([&](Scene scene, const auto& x, std::uint64_t) {
        const bool is_isotropic = scene.is_isotropic();
        if (scene.sources.size() > 8 && (!is_isotropic || scene.sources.size() > 30)) return;
        scene.options.octree_depth = 8;
        scene.options.kd_depth = 24;
        const auto space = editable(structure.make(scene.options));
        const AdaptationReport report = space->adapt({.sources = scene.sources,
                                                      .continuous = nullptr,
                                                      .ratio = scene.options.ratio,
                                                      .target = target,
                                                      .max_leaves = 2000});
        if (!report.met) return;
        const double largest = largest_metric(scene.options).xx;
        const std::vector<Metric> m = answers(*space, x);
        for (std::size_t i = 0; i < x.size(); ++i) {
            CAPTURE(x[i].transpose(), to_string(m[i]), report.reached);
            if (is_isotropic) {
                const Real exact = oracle_length(scene.sources, scene.options.ratio, largest, x[i]);
                REQUIRE(isotropic_delta(m[i].xx, exact) <= most);
                continue;
            }
            for (const PointSource& source : scene.sources) {
                const Real factor = oracle_factor(source, scene.options.ratio, x[i]);
                const Real k = std::max(
                    Real{1}, oracle_excess(m[i], static_cast<double>(factor) * source.metric));
                REQUIRE(static_cast<double>(k + 1 / k - 2) <= most);
            }
        }
    });
}

STRUCTURE_CASE(is_exact, "order-free scenes are as large as their cones in turn") {
    constexpr double gap = 0.01;  // three times what the tolerance of 1e-3 allows
    for_each_scene([&](Scene scene, const auto& x, std::uint64_t) {
        if (scene.is_isotropic()) return;
        scene.options.intersection = IntersectionRule::order_free;
        const auto space = inserted(structure, scene);
        const Metric largest = largest_metric(scene.options);
        for (std::size_t i = 0; i < x.size(); i += 5) {
            const Metric m = sample_at(*space, x[i]);
            const Real in_turn =
                oracle_log_volume_in_turn(scene.sources, scene.options.ratio, largest, x[i]);
            CAPTURE(x[i].transpose(), to_string(m));
            REQUIRE(static_cast<double>(oracle_log_volume(m)) >=
                    static_cast<double>(in_turn) - gap);
        }
    });
}

}  // namespace controlspace::scenes_test
