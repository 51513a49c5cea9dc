// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Geometry>
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <numeric>
#include <random>
#include <tuple>
#include <utility>
#include <vector>

#include "case_of_each.h"
#include "controlspace/baselines/catalogue.h"
#include "controlspace/measure/reference.h"
#include "controlspace/metric/nonconformity.h"
#include "controlspace/sources/sampled_surfaces.h"
#include "controlspace/space/adaptation.h"
#include "controlspace/space/sample_parallel.h"
#include "editable_space.h"

// What adaptation reports as met is searched where it is most likely to be broken: small random
// scenes, each searched by a multistart for its worst place. Some run as tests;
// many by tests_adaptation "[promise]", which prints a row for each: CONTROLSPACE_SCENES is their
// number for each structure (20 unless it is set), CONTROLSPACE_FIRST_SCENE the seed of the first,
// CONTROLSPACE_STARTS that of places where a search of tensors starts (94000).

namespace controlspace::promise_test {
namespace {

const Box domain{Point(-1, -1, -1), Point(1, 1, 1)};

struct Scene {
    std::vector<PointSource> sources;
    double ratio;
    double target = 0.1;
};

class Random {
public:
    explicit Random(std::uint64_t seed) : generator_(seed) {}
    double between(double low, double high) {
        return std::uniform_real_distribution<>(low, high)(generator_);
    }
    double log_between(double low, double high) {
        return std::exp(between(std::log(low), std::log(high)));
    }
    Point place() { return {between(-1, 1), between(-1, 1), between(-1, 1)}; }
    Vector direction() {
        std::normal_distribution<> normal;
        return Vector(normal(generator_), normal(generator_), normal(generator_)).normalized();
    }

private:
    std::mt19937_64 generator_;
};

Scene isotropic_scene(std::uint64_t seed) {
    Random random(3 * seed + 700001);
    constexpr double ratios[] = {1.05, 1.25, 1.5, 10};
    Scene scene{{}, ratios[seed % 4]};
    const int count = static_cast<int>(random.log_between(1, 61));
    const double least = random.log_between(0.01, 0.2);
    for (int i = 0; i < count; ++i) {
        Point q = random.place();
        // Just beside the plane of a cut.
        if (random.between(0, 1) < 0.3) q.x() = std::round(8 * q.x()) / 8 * (1 - 1e-4);
        scene.sources.push_back({q, Metric::isotropic(least * random.log_between(1, 10))});
    }
    return scene;
}

// Discs, needles and others, of up to 100:1.
Scene tensor_scene(std::uint64_t seed) {
    Random random(3 * seed + 700002);
    Scene scene{{}, seed % 2 == 0 ? 1.25 : 1.5};
    const int count = static_cast<int>(random.log_between(1, 61));
    const double most = random.log_between(0.2, 1);
    const double least = most / random.log_between(1, 100);
    for (int i = 0; i < count; ++i) {
        const Vector u = random.direction();
        const Vector v = u.cross(random.direction()).normalized();
        Eigen::Matrix3d directions;
        directions << u, v, u.cross(v);
        const Vector lengths(random.log_between(least, most), random.log_between(least, most),
                             random.log_between(least, most));
        const Eigen::Matrix3d metric = directions * lengths.asDiagonal() * directions.transpose();
        scene.sources.push_back({random.place(), Metric::from_matrix(metric)});
    }
    return scene;
}

// More than that: scattered, in clusters, near a plane, or on a sphere as layers; of 10:1 or 100:1.
Scene scene_of_many(std::uint64_t seed) {
    Random random(3 * seed + 700003);
    Scene scene{{}, seed / 8 % 2 == 0 ? 1.25 : 1.5};
    const int count = static_cast<int>(random.log_between(65, 401));
    const double most = random.log_between(0.2, 1);
    const double least = most / (seed / 4 % 2 == 0 ? 100 : 10);
    const Vector normal = random.direction();
    const double radius = random.between(0.3, 0.9);
    std::vector<Point> centres;
    for (int k = 0; k < 4; ++k) centres.push_back(0.8 * random.place());
    for (int i = 0; i < count; ++i) {
        Vector u = random.direction();
        Point q = random.place();
        Vector lengths(random.log_between(least, most), random.log_between(least, most),
                       random.log_between(least, most));
        switch (seed % 4) {
            case 0:
                break;
            case 1:
                q = centres[static_cast<std::size_t>(i) % centres.size()] +
                    random.log_between(1e-3, 0.3) * random.direction();
                break;
            case 2:
                q += (random.between(-1, 1) * 1e-3 - normal.dot(q)) * normal;
                if (i % 2 == 0) u = normal;
                break;
            default:
                q = radius * u;
                lengths = {least, most * random.between(0.5, 1), most * random.between(0.5, 1)};
        }
        const Vector v = u.cross(random.direction()).normalized();
        Eigen::Matrix3d directions;
        directions << u, v, u.cross(v);
        const Eigen::Matrix3d metric = directions * lengths.asDiagonal() * directions.transpose();
        q = q.cwiseMax(domain.low).cwiseMin(domain.high);
        scene.sources.push_back({q, Metric::from_matrix(metric)});
    }
    return scene;
}

// Layers on the paper's surfaces, 0.06 along them: 4:1 and 100:1, at δ 0.1, and with each length
// within 1.4.
Scene layers(std::uint64_t k) {
    constexpr double across[] = {0.25, 0.01};
    const double s_n = across[k % 2];
    const double target = k / 2 % 2 == 0 ? 0.1 : nonconformity_along(1.4);
    return {k / 4 % 2 == 0 ? sample_sphere({.s_a = 4, .s_n = s_n})
                           : sample_planes({.s_a = 4, .s_n = s_n}),
            1.25, target};
}

Point into_domain(const Point& x) { return x.cwiseMax(domain.low).cwiseMin(domain.high); }

// The largest δ that a multistart finds: from random places, from places at all distances from
// sources, from their projections onto leaves nearby, and from corners of leaves.
std::pair<double, Point> worst_found(const ControlSpace& space, const ControlSpace& field,
                                     const Scene& scene, std::size_t starts, std::uint64_t seed) {
    Random random(seed + 900001);
    std::vector<Point> x;
    while (x.size() < starts) {
        x.push_back(random.place());
        const Box leaf = *space.cell_at(x.back());
        const auto any_side = [&](Axis a) {
            return random.between(0, 1) < 0.5 ? leaf.low[a] : leaf.high[a];
        };
        x.emplace_back(any_side(0), any_side(1), any_side(2));
        const auto number =
            static_cast<std::size_t>(random.between(0, static_cast<double>(scene.sources.size())));
        const Point& q = scene.sources[std::min(number, scene.sources.size() - 1)].position;
        x.push_back(into_domain(q + random.log_between(1e-4, 0.5) * random.direction()));
        const Box beside = *space.cell_at(x.back());
        x.push_back(q.cwiseMax(beside.low).cwiseMin(beside.high));
    }
    const auto deltas = [&](const std::vector<Point>& at) {
        std::vector<Metric> own(at.size());
        std::vector<Metric> exact(at.size());
        sample_parallel(space, at, own);
        sample_parallel(field, at, exact);
        std::vector<std::pair<double, Point>> found(at.size());
        for (std::size_t i = 0; i < at.size(); ++i) {
            found[i] = {directional_nonconformity(own[i], exact[i]), at[i]};
        }
        return found;
    };
    auto best = deltas(x);
    const auto is_worse = [](const auto& a, const auto& b) { return a.first > b.first; };
    std::ranges::sort(best, is_worse);
    best.resize(std::min<std::size_t>(best.size(), 24));
    double step = 0.05;
    for (int round = 0; round < 60; ++round, step *= 0.86) {
        std::vector<Point> tries;
        for (const auto& [delta, at] : best) {
            for (int k = 0; k < 4; ++k) {
                tries.push_back(
                    into_domain(at + random.log_between(0.1, 1) * step * random.direction()));
            }
        }
        const auto found = deltas(tries);
        for (std::size_t i = 0; i < found.size(); ++i) {
            if (found[i].first > best[i / 4].first) best[i / 4] = found[i];
        }
    }
    return std::ranges::max(best, {}, [](const auto& b) { return b.first; });
}

struct Outcome {
    double target = 0;
    std::size_t sources = 0, leaves = 0;
    double megabytes = 0, seconds = 0;  // of processor time, to adapt
    bool met = false;
    double reached = 0, worst = 0;  // as reported; as found, where met
    Point where = Point::Zero();
    Box leaf = {};  // there
    bool is_broken() const { return worst > target * (1 + 1e-9); }
};

Outcome outcome_of(const CatalogueEntry& entry, const Scene& scene, std::size_t starts,
                   std::uint64_t seed) {
    const auto space = editable(entry.make({.domain = domain}));
    Outcome outcome{.target = scene.target, .sources = scene.sources.size()};
    const std::clock_t start = std::clock();
    const AdaptationReport report = space->adapt({.sources = scene.sources,
                                                  .continuous = nullptr,
                                                  .ratio = scene.ratio,
                                                  .target = scene.target,
                                                  .max_leaves = 300000});
    outcome.seconds = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
    outcome.leaves = space->footprint().cells;
    outcome.megabytes = 1e-6 * static_cast<double>(space->footprint().bytes_total());
    outcome.met = report.met;
    outcome.reached = report.reached;
    if (!report.met) return outcome;
    const auto field = exact_reference(scene.sources, scene.ratio, largest_metric(domain), 1e-4);
    std::tie(outcome.worst, outcome.where) = worst_found(*space, *field, scene, starts, seed);
    outcome.leaf = *space->cell_at(outcome.where);
    return outcome;
}

struct Outcomes {
    int scenes = 0, met = 0, broken = 0;
    double worst = 0;
};

Outcomes search(const CatalogueEntry& entry, Scene (*make)(std::uint64_t),
                const std::vector<std::uint64_t>& scenes, std::size_t starts) {
    Outcomes all;
    for (const std::uint64_t k : scenes) {
        const Outcome outcome = outcome_of(entry, make(k), starts, k);
        ++all.scenes;
        all.met += outcome.met;
        all.broken += outcome.is_broken();
        all.worst = std::max(all.worst, outcome.worst);
    }
    return all;
}

std::vector<std::uint64_t> first_scenes(std::uint64_t count) {
    std::vector<std::uint64_t> scenes(count);
    std::iota(scenes.begin(), scenes.end(), std::uint64_t{0});
    return scenes;
}

std::uint64_t number_from(const char* variable, std::uint64_t otherwise) {
    const char* text = std::getenv(variable);
    return text == nullptr ? otherwise : std::strtoull(text, nullptr, 10);
}

// The number of scenes above their target.
int print_scenes(const CatalogueEntry& entry, const char* kind, Scene (*make)(std::uint64_t),
                 std::size_t starts) {
    const std::uint64_t first = number_from("CONTROLSPACE_FIRST_SCENE", 0);
    const std::uint64_t count = number_from("CONTROLSPACE_SCENES", 20);
    int broken = 0;
    for (std::uint64_t k = first; k < first + count; ++k) {
        const Outcome outcome = outcome_of(entry, make(k), starts, k);
        broken += outcome.is_broken();
        std::printf("scene,%s,%s,%llu,%.4g,%zu,%zu,%.3f,%.2f,%d,%.6g,%.6g\n", kind,
                    entry.id.c_str(), static_cast<unsigned long long>(k), outcome.target,
                    outcome.sources, outcome.leaves, outcome.megabytes, outcome.seconds,
                    outcome.met, outcome.reached, outcome.worst);
        if (outcome.is_broken()) {
            const Vector edges = outcome.leaf.edges();
            const Vector share = (outcome.where - outcome.leaf.low).cwiseQuotient(edges);
            std::printf("# at %.9g %.9g %.9g: %.4f %.4f %.4f of a leaf of %.3g %.3g %.3g\n",
                        outcome.where.x(), outcome.where.y(), outcome.where.z(), share.x(),
                        share.y(), share.z(), edges.x(), edges.y(), edges.z());
        }
        std::fflush(stdout);
    }
    return broken;
}

std::vector<CatalogueEntry> named(std::initializer_list<const char*> ids) {
    std::vector<CatalogueEntry> entries;
    for (const char* id : ids) entries.push_back(tree_named(id));
    return entries;
}

std::vector<CatalogueEntry> of_isotropic() { return named({"K_L", "K_oL", "K_V", "K_oV", "K_LA"}); }
// Leaves of one metric would be millions.
std::vector<CatalogueEntry> of_tensors() { return named({"K_V", "K_oV"}); }
std::vector<CatalogueEntry> nearly_of_tensors() { return named({"K_LA"}); }

}  // namespace

CASE_OF_EACH(entry, of_isotropic(), "a promise is kept of isotropic scenes") {
    const Outcomes outcome = search(entry, isotropic_scene, first_scenes(12), 4000);
    CHECK(outcome.met >= 8);
    CHECK(outcome.broken == 0);
}

// Scenes in which leaves passed although a search finds 0.104 to 0.134 in them: sources just beyond
// a face, cones that meet on one, the tip of a cone near a corner, a crease across a long edge, a
// peak that is lower than another where the leaf is sampled.
CASE_OF_EACH(entry, of_tensors(), "a promise is kept of scenes of tensors", "[long]") {
    const Outcomes outcome =
        search(entry, tensor_scene, {24, 29, 50, 73, 85, 91, 10072, 60197, 70040}, 94000);
    CHECK(outcome.met == outcome.scenes);
    CHECK(outcome.broken == 0);
}

CASE_OF_EACH(entry, nearly_of_tensors(), "a promise is nearly kept of scenes of tensors",
             "[long]") {
    const Outcomes outcome = search(entry, tensor_scene, first_scenes(4), 1000);
    CHECK(outcome.met >= 2);
    CHECK(outcome.worst <= 0.1);
}

CASE_OF_EACH(entry, of_isotropic(), "many scenes, isotropic", "[.][promise][lengths]") {
    CHECK(print_scenes(entry, "isotropic", isotropic_scene, 20000) == 0);
}

CASE_OF_EACH(entry, of_tensors(), "many scenes, up to 60 tensors", "[.][promise][tensors]") {
    const auto starts = number_from("CONTROLSPACE_STARTS", 94000);
    CHECK(print_scenes(entry, "tensors", tensor_scene, starts) == 0);
}

CASE_OF_EACH(entry, of_tensors(), "many scenes, more than 64 tensors", "[.][promise][many]") {
    const auto starts = number_from("CONTROLSPACE_STARTS", 94000);
    CHECK(print_scenes(entry, "many tensors", scene_of_many, starts) == 0);
}

CASE_OF_EACH(entry, of_tensors(), "layers", "[.][promise][layers]") {
    const auto starts = number_from("CONTROLSPACE_STARTS", 1000000);
    CHECK(print_scenes(entry, "layers", layers, starts) == 0);
}

CASE_OF_EACH(entry, nearly_of_tensors(), "many scenes, up to 60 tensors, nearly", "[.][promise]") {
    CHECK_NOFAIL(print_scenes(entry, "tensors", tensor_scene, 4000) == 0);
}

}  // namespace controlspace::promise_test
