// SPDX-License-Identifier: Apache-2.0
#include "controlspace/space/adaptation.h"

#include <tbb/global_control.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <chrono>
#include <cmath>
#include <limits>

#include "case_of_each.h"
#include "controlspace/baselines/catalogue.h"
#include "controlspace/error.h"
#include "controlspace/input_errors.h"
#include "controlspace/measure/access_time.h"
#include "controlspace/measure/accuracy.h"
#include "controlspace/metric/intersection.h"
#include "controlspace/metric/nonconformity.h"
#include "controlspace/sources/cone.h"
#include "controlspace/sources/sampled_surfaces.h"
#include "editable_space.h"
#include "space/goal_field.h"

namespace controlspace::adaptation_test {
namespace {

const Box domain{Point(-1, -1, -1), Point(1, 1, 1)};
constexpr double g = 1.25;

// h grows from 0.1 by 0.2 per unit length towards +x.
class Ramp final : public ControlSpace {
public:
    void sample(std::span<const Point> x, std::span<Metric> out) const override {
        for (std::size_t i = 0; i < x.size(); ++i) {
            out[i] = Metric::isotropic(0.3 + 0.2 * x[i].x());
        }
    }
};

// Discs that turn about z along x: no length of theirs changes.
class Turning final : public ControlSpace {
public:
    void sample(std::span<const Point> x, std::span<Metric> out) const override {
        for (std::size_t i = 0; i < x.size(); ++i) {
            const Vector u(std::cos(1.2 * x[i].x()), std::sin(1.2 * x[i].x()), 0);
            out[i] =
                Metric::from_matrix(0.4 * Eigen::Matrix3d::Identity() - 0.3 * u * u.transpose());
        }
    }
};

// Discs of random size and direction.
std::vector<PointSource> tensors(std::size_t n) {
    const std::vector<Point> places = random_points(domain, n, 3);
    const std::vector<Point> normals = random_points(domain, n, 4);
    std::vector<PointSource> sources;
    for (std::size_t i = 0; i < n; ++i) {
        const Vector u = normals[i].normalized();
        const double h = 0.3 + 0.3 * std::abs(normals[i].x());
        sources.push_back({0.7 * places[i], Metric::from_matrix(h * (Eigen::Matrix3d::Identity() -
                                                                     0.6 * u * u.transpose()))});
    }
    return sources;
}

// Share of random places where δ to the field is beyond `target`.
double share_beyond(double target, const ControlSpace& space, const ControlSpace& field) {
    const std::vector<Point> x = random_points(domain, 20000, 11);
    std::vector<Metric> own(x.size());
    std::vector<Metric> exact(x.size());
    space.sample(x, own);
    field.sample(x, exact);
    std::size_t beyond = 0;
    for (std::size_t i = 0; i < x.size(); ++i) {
        if (nonconformity(own[i], exact[i]) > target) ++beyond;
    }
    return double(beyond) / double(x.size());
}

/// Trees whose answers are bounded everywhere: all but those of quadratic leaves.
std::vector<CatalogueEntry> bounded_trees() {
    std::vector<CatalogueEntry> bounded(all_trees().begin(), all_trees().end());
    std::erase_if(bounded, [](const CatalogueEntry& entry) { return entry.order == 2; });
    return bounded;
}

/// Trees that are trilinear between vertices.
std::vector<CatalogueEntry> vertex_trees() { return {tree_named("K_V"), tree_named("K_oV")}; }

/// Trees that follow thin layers with few leaves.
std::vector<CatalogueEntry> trees_of_layers() {
    std::vector<CatalogueEntry> trees = vertex_trees();
    for (const CatalogueEntry& entry : anchored_catalogue()) trees.push_back(entry);
    return trees;
}

}  // namespace

CASE_OF_EACH(
    entry, all_trees(),
    "trees keep the target at places they have not seen, and a closer one takes more leaves",
    "[long]") {
    const std::vector<PointSource> isotropic = sample_sphere({.h = 0.08});
    const std::vector<PointSource> discs = tensors(3);
    for (const std::vector<PointSource>& sources : {isotropic, discs}) {
        const auto field = exact_reference(sources, g, largest_metric(domain));
        CAPTURE(sources.size());
        std::size_t leaves = 0;
        for (const double target : {1.0, 0.3}) {
            const auto space = editable(entry.make({.domain = domain}));
            const AdaptationReport report = space->adapt({sources, nullptr, g, target});
            CHECK(report.met);
            CHECK(report.reached <= target);
            CHECK(report.shortfall.empty());
            CHECK(share_beyond(target, *space, *field) <= 2e-4);
            CHECK(space->footprint().cells >= leaves);
            leaves = space->footprint().cells;
        }
    }
}

CASE_OF_EACH(entry, all_trees(), "trees keep the target of an order-free field", "[long]") {
    constexpr double target = 0.3;
    constexpr auto order_free = IntersectionRule::order_free;
    const std::vector<PointSource> sources = tensors(12);
    const auto field = exact_reference(sources, g, largest_metric(domain), 1e-3, order_free);
    const auto space = editable(entry.make({.domain = domain, .intersection = order_free}));
    CHECK(space->adapt({sources, nullptr, g, target, order_free}).met);
    CHECK(share_beyond(target, *space, *field) <= 5e-4);
}

CASE_OF_EACH(entry, vertex_trees(), "thin metrics: no length is off in any direction", "[long]") {
    constexpr double target = 0.5;
    std::vector<PointSource> sources;
    const std::vector<Point> normals = random_points(domain, 6, 41);
    const std::vector<Point> places = random_points(domain, 6, 42);
    for (std::size_t i = 0; i < 6; ++i) {
        const Vector u = normals[i].normalized();
        sources.push_back({0.8 * places[i], Metric::from_matrix(0.3 * Eigen::Matrix3d::Identity() -
                                                                0.297 * u * u.transpose())});
    }
    const auto field = exact_reference(sources, g, largest_metric(domain), 1e-3);
    const auto space = editable(entry.make({.domain = domain}));
    CHECK(space->adapt({sources, nullptr, g, target}).met);
    const std::vector<Point> x = random_points(domain, 20000, 43);
    std::vector<Metric> own(x.size());
    std::vector<Metric> exact(x.size());
    space->sample(x, own);
    field->sample(x, exact);
    std::size_t beyond = 0;
    double most = 1;
    for (std::size_t i = 0; i < x.size(); ++i) {
        const double k = std::max(growth(own[i], exact[i]), growth(exact[i], own[i]));
        beyond += (k - 1) * (k - 1) / k > target ? 1 : 0;
        most = std::max(most, k);
    }
    CHECK(beyond <= 4);
    CHECK(most <= 3);  // between samples; the target allows 2
}

CASE_OF_EACH(entry, vertex_trees(), "layers: lengths keep the target in each direction", "[long]") {
    constexpr double target = 0.1;
    const std::vector<PointSource> sources = sample_sphere({.h = 0.25, .s_a = 4, .s_n = 0.25});
    const auto field = exact_reference(sources, g, largest_metric(domain), 1e-3);
    const auto space = editable(entry.make({.domain = domain}));
    const AdaptationReport report = space->adapt({sources, nullptr, g, target});
    CHECK(report.met);
    CHECK(!report.is_bound);
    const auto delta = [&](const Point& x) {
        return directional_nonconformity(sample_at(*space, x), sample_at(*field, x));
    };
    std::vector<std::pair<double, Point>> worst;
    for (const Point& x : random_points(domain, 20000, 71)) worst.emplace_back(delta(x), x);
    const auto is_worse = [](const auto& a, const auto& b) { return a.first > b.first; };
    std::ranges::sort(worst, is_worse);
    const std::size_t beyond = static_cast<std::size_t>(
        std::ranges::find_if(worst, [&](const auto& p) { return p.first <= target; }) -
        worst.begin());
    CHECK(beyond <= 20);
    // Uphill from the worst places.
    constexpr std::size_t starts = 20;
    worst.resize(starts);
    for (auto& [most, at] : worst) {
        double step = 0.01;
        for (const Point& v : random_points(domain, 200, 72)) {
            const Point x = (at + step * v).cwiseMax(domain.low).cwiseMin(domain.high);
            const double found = delta(x);
            if (found > most) {
                most = found;
                at = x;
            } else {
                step *= 0.98;
            }
        }
        CHECK(most <= 1.5 * target);
    }
}

CASE_OF_EACH(
    entry, anchored_catalogue(),
    "trees that keep sources keep the target of thin layers, in a quarter of K_oV's leaves",
    "[long]") {
    constexpr double target = 0.2;
    const std::vector<PointSource> sources = sample_sphere({.h = 0.12, .s_a = 4, .s_n = 0.25});
    const auto field = exact_reference(sources, g, largest_metric(domain), 1e-3);
    const auto space = editable(entry.make({.domain = domain}));
    CHECK(space->adapt({sources, nullptr, g, target}).met);
    CHECK(share_beyond(target, *space, *field) == 0);
    const auto vertices = editable(tree_named("K_oV").make({.domain = domain}));
    CHECK(vertices->adapt({sources, nullptr, g, target}).met);
    CHECK(4 * space->footprint().cells < vertices->footprint().cells);

    // Within the cones of all sources, as no search finds them.
    double most = 0;
    for (const Point& x : random_points(domain, 500, 12)) {
        const Metric own = sample_at(*space, x);
        for (const PointSource& s : sources) {
            most = std::max(most, growth(own, cone_factor(s, g, x) * s.metric));
        }
    }
    CHECK(most > 0.99);
    CHECK(most <= largest_factor_along(target));
}

CASE_OF_EACH(entry, anchored_catalogue(),
             "tensors and a continuous field: trees that keep sources keep the target of both") {
    constexpr double target = 0.1;
    const std::vector<PointSource> sources = tensors(6);
    const auto ramp = std::make_shared<Ramp>();
    const auto field = exact_reference(sources, g, largest_metric(domain), 1e-3,
                                       IntersectionRule::order_free, ramp);
    const auto space = editable(entry.make({.domain = domain}));
    CHECK(space->adapt({sources, ramp, g, target}).met);
    CHECK(share_beyond(target, *space, *field) <= 5e-4);
}

TEST_CASE("sphere at a tenth: the paper's trees and the anchored ones, on 101^3 places", "[long]") {
    const std::vector<PointSource> sources = sample_sphere({.rho = 1});
    const auto field = exact_reference(sources, g, largest_metric(domain));
    const Probes probes = make_probes(*field, cell_centres(domain, 101));
    const auto adapted = [&](const CatalogueEntry& entry, double most_megabytes,
                             double target = 0.1) {
        CAPTURE(entry.id);
        const auto space = editable(entry.make({.domain = domain}));
        const AdaptationReport report = space->adapt({sources, nullptr, g, target});
        CHECK(report.met);
        CHECK(space->footprint().bytes_total() <= static_cast<std::size_t>(most_megabytes * 1e6));
        return accuracy(*space, probes).max;
    };
    CHECK(adapted(tree_named("K_L"), 4) <= 0.1);
    CHECK(adapted(tree_named("K_oL"), 4) <= 0.1);
    CHECK(adapted(tree_named("K_V"), 1) <= 0.1);
    CHECK(adapted(tree_named("K_oLA"), 2) <= 0.1);
    CHECK(adapted(tree_named("K_LA"), 2) <= 0.1);
    CHECK(adapted(tree_named("K_oLA"), 4, 0.02) <= 0.02);
    CHECK(adapted(tree_named("K_LA"), 4, 0.02) <= 0.02);
}

CASE_OF_EACH(entry, bounded_trees(), "trees keep the target everywhere, as bounds prove") {
    std::vector<PointSource> scattered;
    for (const Point& x : random_points(domain, 300, 17)) {
        scattered.push_back({x, Metric::isotropic(0.02 + 0.1 * std::abs(x.x() * x.y()))});
    }
    for (const auto& sources : {scattered, sample_sphere({.h = 0.08})}) {
        const auto field = exact_reference(sources, g, largest_metric(domain));
        const Probes probes = make_probes(*field, random_points(domain, 50000, 19));
        const auto space = editable(entry.make({.domain = domain}));
        const AdaptationReport report = space->adapt({sources, nullptr, g, 0.2});
        CHECK(report.met);
        const double seen = accuracy(*space, probes).max;
        CHECK(seen <= report.reached);
        CHECK(seen > (entry.has<KeptSources>() ? 0.1 : 0.5) * report.reached);
    }
}

// At random places with the lengths of the field of ten cones, whose tips are not among them.
std::vector<PointSource> on_cones(std::size_t n) {
    const std::vector<Point> tips = random_points(domain, 10, 21);
    std::vector<PointSource> sources;
    for (const Point& x : random_points(domain, n, 22)) {
        double h = 1;
        for (std::size_t k = 0; k < tips.size(); ++k) {
            const double own = 0.005 * std::pow(1.3, static_cast<double>(k));
            h = std::min(h, own + (g - 1) * (x - tips[k]).norm());
        }
        sources.push_back({x, Metric::isotropic(h)});
    }
    return sources;
}

TEST_CASE("thinned sources take their share of the target, and no other field is thinned") {
    constexpr double target = 0.1;
    constexpr auto allowed = GoalField::Thinning::allowed;
    const std::vector<PointSource> sources = on_cones(16000);
    const AdaptationGoal goal{
        .sources = sources, .continuous = nullptr, .ratio = g, .target = target};
    const GoalField thinned(goal, domain, 0, allowed);
    CHECK(thinned.kept().size() < sources.size() / 2);
    const double k = largest_factor_within(target);
    CHECK(largest_factor_within(thinned.target()) == Approx(std::pow(k, 0.9)));
    CHECK(thinned.departure_from_all(thinned.target()) == target);
    CHECK(thinned.departure_from_all(0) == Approx(nonconformity_of_factor(std::pow(k, 0.1))));
    CHECK(thinned.departure_from_all(std::nextafter(thinned.target(), 1)) > target);

    const GoalField all(goal, domain);
    CHECK(all.kept().size() == sources.size());
    CHECK(all.target() == target);
    CHECK(all.departure_from_all(0.03) == 0.03);
    const std::vector<PointSource> sphere = sample_sphere({});
    const GoalField usual({.sources = sphere, .continuous = nullptr, .ratio = g, .target = target},
                          domain, 0, allowed);
    CHECK(usual.target() == target);
}

CASE_OF_EACH(entry, bounded_trees(), "trees of thinned sources keep the target of all sources",
             "[long]") {
    const std::vector<PointSource> sources = on_cones(16000);
    const auto space = editable(entry.make({.domain = domain}));
    const AdaptationReport report = space->adapt({.sources = sources,
                                                  .continuous = nullptr,
                                                  .ratio = g,
                                                  .target = 0.3,
                                                  .max_leaves = 100000});
    CHECK(report.met);
    CHECK(report.is_bound);
    const auto field = brute_force_reference(sources, g, largest_metric(domain));
    std::vector<Point> x = random_points(domain, 1500, 23);
    for (std::size_t i = 0; i < sources.size(); i += 16) x.push_back(sources[i].position);
    const double seen = accuracy(*space, make_probes(*field, x)).max;
    CHECK(seen <= report.reached);
    CHECK(report.reached <= 0.3);
}

CASE_OF_EACH(entry, vertex_trees(), "few sources: vertices keep the target everywhere") {
    // Sources just beyond a face of a leaf are hidden from it: some lie near to planes of cuts.
    const std::vector<Point> places = random_points(domain, 300, 101);
    const std::vector<Point> lengths = random_points(domain, 300, 102);
    int kept = 0;
    for (std::size_t k = 0; k < 60; ++k) {
        CAPTURE(k);
        const double ratio = k % 3 == 0 ? 1.5 : k % 10 == 1 ? 10 : 1.25;
        const double target = k % 4 == 0 ? 0.05 : 0.3;
        std::vector<PointSource> sources;
        for (std::size_t i = 0; i <= k % 3; ++i) {
            Point q = places[5 * k + i];
            if (k % 2 == 0) q.x() = std::round(8 * q.x()) / 8 * (1 - 2e-4);
            const double h = std::pow(10, -1.2 + lengths[5 * k + i].x());
            sources.push_back({q, Metric::isotropic(h)});
        }
        const auto space = editable(entry.make({.domain = domain}));
        const AdaptationReport report = space->adapt({sources, nullptr, ratio, target});
        if (!report.met) continue;
        ++kept;
        // At random places, and in the leaf of each source and in those beside it.
        std::vector<Point> x = random_points(domain, 20000, 103 + k);
        for (const PointSource& s : sources) {
            for (const Point& t : random_points(domain, 3000, 104 + k)) {
                const Vector way = std::pow(10, -2 - t.y()) * t;
                x.push_back((s.position + way).cwiseMax(domain.low).cwiseMin(domain.high));
                const Box cell = *space->cell_at(x.back());
                x.push_back(s.position.cwiseMax(cell.low).cwiseMin(cell.high));
            }
        }
        const auto field = exact_reference(sources, ratio, largest_metric(domain));
        const Probes probes = make_probes(*field, x);
        CHECK(accuracy(*space, probes).max <= target);
    }
    CHECK(kept >= 50);
}

CASE_OF_EACH(entry, all_trees(), "the same tree, whatever the number of threads", "[threads]") {
    const std::vector<Point> x = random_points(domain, 2000, 23);
    std::vector<Metric> one(x.size());
    std::vector<Metric> many(x.size());
    const auto fill = [&](const AdaptationGoal& goal, std::size_t threads, std::span<Metric> out) {
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
        const auto space = editable(entry.make({.domain = domain}));
        const double reached = space->adapt(goal).reached;
        space->sample(x, out);
        return reached;
    };
    const std::vector<PointSource> isotropic = sample_sphere({.h = 0.08});
    const std::vector<PointSource> discs = tensors(80);
    for (const AdaptationGoal& goal :
         {AdaptationGoal{isotropic, nullptr, g, 0.2}, AdaptationGoal{discs, nullptr, g, 1.0}}) {
        CAPTURE(goal.sources.size());
        CHECK(fill(goal, 1, one) == fill(goal, 4, many));
        CHECK(one == many);
    }
}

CASE_OF_EACH(entry, trees_of_layers(), "the same tree of layers, whatever the number of threads",
             "[long]") {
    const std::vector<PointSource> sources = sample_sphere({.h = 0.25, .s_a = 4, .s_n = 0.25});
    const std::vector<Point> x = random_points(domain, 2000, 24);
    std::vector<std::vector<Metric>> found;
    for (const std::size_t threads : {1, 4}) {
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
        const auto space = editable(entry.make({.domain = domain}));
        space->adapt({sources, nullptr, g, 0.2});
        space->sample(x, found.emplace_back(x.size()));
        CHECK(found.back() == found.front());
    }
}

CASE_OF_EACH(entry, all_trees(),
             "a source too small to be seen from a leaf's own places is found") {
    const PointSource source{Point(0.31, 0.17, -0.43), Metric::isotropic(1e-4)};
    const auto space = editable(entry.make({.domain = domain}));
    CHECK(space->adapt({{&source, 1}, nullptr, g, 0.1}).met);
    CHECK(nonconformity(sample_at(*space, source.position), source.metric) <= 0.1);
}

CASE_OF_EACH(entry, all_trees(), "without sources the root is enough") {
    const auto space = editable(entry.make({.domain = domain}));
    CHECK(space->adapt({{}, nullptr, g, 0.1}).reached < 1e-12);
    CHECK(space->footprint().cells == 1);
}

CASE_OF_EACH(
    entry, structures(),
    "a continuous source: vertices carry a linear field, anchored trees the field itself") {
    const auto ramp = std::make_shared<Ramp>();
    const auto space = editable(entry.make({.domain = domain, .finest_length = 0.05}));
    const AdaptationReport report = space->adapt({{}, ramp, g, 0.05});
    CHECK(report.met);
    CHECK(share_beyond(0.05, *space, *ramp) == 0);
    if (entry.id == "K_V" || entry.id == "K_oV" || entry.family == "anchored") {
        CHECK(space->footprint().cells == 1);
        CHECK(report.reached < 1e-12);
    }
}

TEST_CASE("kd-trees are cut where metrics turn, though their lengths are the same everywhere") {
    const auto turning = std::make_shared<Turning>();
    for (const char* id : {"K_L", "K_Li", "K_V"}) {
        CAPTURE(id);
        const auto space = editable(tree_named(id).make({.domain = domain}));
        CHECK(space->adapt({{}, turning, g, 0.1}).met);
        CHECK(space->footprint().cells >= 4);
        for (const Point& x : random_points(domain, 500, 5)) {
            const Vector edges = space->cell_at(x).value().edges();
            CHECK(edges.x() < 2);
            CHECK(edges.y() == 2);
            CHECK(edges.z() == 2);
        }
    }
}

CASE_OF_EACH(entry, all_trees(),
             "mixture: sources and a continuous one, each where it is smaller, insertion goes on") {
    const auto ramp = std::make_shared<Ramp>();
    const PointSource source{Point(0.5, 0.2, 0.1), Metric::isotropic(0.02)};
    const PointSource later{Point(-0.4, -0.3, 0.6), Metric::isotropic(0.03)};
    const auto space = editable(entry.make({.domain = domain}));
    CHECK(space->adapt({{&source, 1}, ramp, g, 0.1}).met);
    for (const Point& x : random_points(domain, 500, 5)) {
        const double cone = 0.02 + (g - 1) * (x - source.position).norm();
        const Metric exact = Metric::isotropic(std::min(cone, 0.3 + 0.2 * x.x()));
        CHECK(nonconformity(sample_at(*space, x), exact) <= 0.1);
    }
    space->insert(later);
    if (entry.order == 2) return;  // at a border between leaves K_Li follows the neighbour
    CHECK(nonconformity(sample_at(*space, later.position), later.metric) <= 0.2);
}

TEST_CASE("a target out of reach is told, with what was reached") {
    const std::vector<PointSource> sources = sample_sphere({.h = 0.06});
    for (const char* id : {"K_L", "K_oL", "K_V", "K_oV"}) {
        CAPTURE(id);
        const auto space =
            editable(tree_named(id).make({.domain = domain, .kd_depth = 6, .octree_depth = 2}));
        const AdaptationReport report = space->adapt({sources, nullptr, g, 0.1});
        CHECK_FALSE(report.met);
        CHECK(report.reached > 0.1);
        CHECK(report.shortfall.find("raise the depth, or target_delta") != std::string::npos);
        CHECK(space->footprint().cells == 64);
    }
    for (const CatalogueEntry& entry : structures()) {
        if (entry.id != "uniform-nearest") continue;
        const auto space = editable(entry.make({.domain = domain, .voxel = 0.5}));
        const AdaptationReport report = space->adapt({sources, nullptr, g, 0.1});
        CHECK_FALSE(report.met);
        CHECK(report.shortfall.find("voxels") != std::string::npos);
    }
    const auto small = editable(tree_named("K_oL").make({.domain = domain, .max_bytes = 1000000}));
    CHECK_THROWS_AS(small->adapt({sources, nullptr, g, 0.01}), InputError);
}

TEST_CASE("what is guaranteed holds where leaves come near the spacing of doubles") {
    const double spacing = std::nextafter(1000.0, 2000.0) - 1000;
    const double edge = 1e-6;
    const Box far{Point::Constant(1000), Point::Constant(1000 + edge)};
    constexpr double steep = 10;
    for (const char* id : {"K_L", "K_oL"}) {
        for (const double in_spacings : {1000.0, 10.0, 1.0, 1e-3}) {
            const auto places = random_points(far, 4, 7);
            int bounded = 0;
            for (const Point& q : places) {
                CAPTURE(id, in_spacings, q);
                const PointSource source{q, Metric::isotropic(in_spacings * spacing)};
                const auto space = editable(
                    tree_named(id).make({.domain = far, .kd_depth = 200, .octree_depth = 60}));
                const AdaptationReport report = space->adapt({{&source, 1}, nullptr, steep, 1});
                if (!report.is_bound) continue;
                ++bounded;
                double worst = 0;
                for (const int reach : {3, 30, 3000}) {
                    const double r = reach * spacing;
                    const Box around{q - Vector::Constant(r), q + Vector::Constant(r)};
                    for (const Point& x : random_points(around, 2000, 3)) {
                        const double exact = source.metric.xx + (steep - 1) * (x - q).norm();
                        worst = std::max(
                            worst, nonconformity(sample_at(*space, x), Metric::isotropic(exact)));
                    }
                }
                CHECK(worst <= report.reached * (1 + 1e-9));
            }
            if (in_spacings > 50) CHECK(bounded == 4);
        }
    }
}

CASE_OF_EACH(entry, all_trees(),
             "a tree at its limit of time or memory says so, and answers with what it has") {
    const std::vector<PointSource> sources = sample_sphere({.h = 0.06});
    const AdaptationGoal goal{sources, nullptr, g, 0.1};
    SpaceOptions options{.domain = domain, .finest_length = 0.06};
    options.growth.deadline = GrowthLimit::Clock::now();
    const auto late = editable(entry.make(options));
    const AdaptationReport report = late->adapt(goal);
    CHECK(report.stop == GrowthStop::time);
    CHECK_FALSE(report.met);
    CHECK(report.shortfall == "no time was left");
    CHECK(late->footprint().cells == 1);
    CHECK(is_positive_definite(sample_at(*late, Point::Zero())));
    CHECK_THROWS_AS(editable(entry.make(options))->insert(sources), GrowthStopped);

    // A limit that is not reached changes nothing.
    const auto free = editable(entry.make({.domain = domain, .finest_length = 0.06}));
    CHECK(free->adapt(goal).met);
    options.growth = {.deadline = GrowthLimit::Clock::now() + std::chrono::hours(1),
                      .bytes = std::size_t{1} << 40};
    const auto limited = editable(entry.make(options));
    CHECK(limited->adapt(goal).stop == GrowthStop::none);
    const auto x = random_points(domain, 1000, 1);
    CHECK(answers(*limited, x) == answers(*free, x));

    options.growth = {.bytes = free->footprint().bytes_total() / 4};
    const auto small = editable(entry.make(options));
    const AdaptationReport stopped = small->adapt(goal);
    CHECK(stopped.stop == GrowthStop::memory);
    CHECK_FALSE(stopped.met);
    CHECK(small->footprint().cells > 1);
    CHECK(small->footprint().cells < free->footprint().cells);
}

CASE_OF_EACH(entry, vertex_trees(),
             "a tree of limited size comes nearer to the field with its size", "[long]") {
    const std::vector<PointSource> sources = tensors(40);
    double before = std::numeric_limits<double>::infinity();
    for (const std::size_t most : {40, 300}) {
        CAPTURE(most);
        const auto space = editable(entry.make({.domain = domain}));
        AdaptationGoal goal{sources, nullptr, g, 0.02};
        goal.max_leaves = most;
        const AdaptationReport report = space->adapt(goal);
        CHECK_FALSE(report.met);
        CHECK(report.shortfall.find("more than " + std::to_string(most) + " leaves") == 0);
        const std::size_t cells = space->footprint().cells;
        CHECK(cells >= most);
        CHECK(cells < most + 8);
        CHECK(report.reached < before);
        before = report.reached;
    }
}

TEST_CASE("bad goals are refused") {
    const auto space = editable(tree_named("K_L").make({.domain = domain}));
    const double nan = std::numeric_limits<double>::quiet_NaN();
    for (const double target : {0.0, -1.0, nan}) {
        CHECK_THROWS_AS(space->adapt({{}, nullptr, g, target}), InputError);
    }
    CHECK_THROWS_AS(space->adapt({{}, nullptr, 0.5, 0.1}), InputError);
    const PointSource outside{Point(2, 0, 0), Metric::isotropic(0.1)};
    CHECK_THROWS_AS(space->adapt({{&outside, 1}, nullptr, g, 0.1}), InputError);
}

}  // namespace controlspace::adaptation_test
