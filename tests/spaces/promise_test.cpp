#include <Eigen/Geometry>
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <random>
#include <utility>
#include <vector>

#include "case_of_each.h"
#include "controlspace/baselines/catalogue.h"
#include "controlspace/measure/reference.h"
#include "controlspace/metric/nonconformity.h"
#include "controlspace/space/adaptation.h"
#include "controlspace/space/sample_parallel.h"
#include "editable_space.h"

// What adaptation reports as met is looked for where it is most likely to be broken: small random
// scenes, each searched by a multistart for its worst place. The first run as tests; all of them
// by tests_adaptation "[promise]", which prints shares and the worst.

using namespace controlspace;

namespace {

const Box domain{Point(-1, -1, -1), Point(1, 1, 1)};
constexpr double target = 0.1;

struct Scene {
    std::vector<PointSource> sources;
    double ratio;
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

Point into_domain(const Point& x) { return x.cwiseMax(domain.low).cwiseMin(domain.high); }

// The largest δ that a multistart finds: from random places, from places at all distances from
// sources, from their projections onto leaves nearby, and from corners of leaves.
double worst_found(const ControlSpace& space, const ControlSpace& field, const Scene& scene,
                   std::size_t starts, std::uint64_t seed) {
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
    return std::ranges::max(best, {}, [](const auto& b) { return b.first; }).first;
}

struct Outcome {
    int scenes = 0, met = 0, broken = 0;
    double worst = 0;
    std::uint64_t worst_scene = 0;
};

Outcome search(const CatalogueEntry& entry, Scene (*make)(std::uint64_t),
               const std::vector<std::uint64_t>& scenes, std::size_t starts) {
    Outcome outcome;
    for (const std::uint64_t k : scenes) {
        const Scene scene = make(k);
        const auto space = editable(entry.make({.domain = domain}));
        const AdaptationReport report = space->adapt({scene.sources, nullptr, scene.ratio, target});
        ++outcome.scenes;
        if (!report.met) continue;
        ++outcome.met;
        const auto field =
            exact_reference(scene.sources, scene.ratio, largest_metric(domain), 1e-4);
        const double worst = worst_found(*space, *field, scene, starts, k);
        if (worst > target * (1 + 1e-9)) ++outcome.broken;
        if (worst > outcome.worst) {
            outcome.worst = worst;
            outcome.worst_scene = k;
        }
    }
    return outcome;
}

std::vector<std::uint64_t> first_scenes(std::uint64_t count) {
    std::vector<std::uint64_t> scenes(count);
    std::iota(scenes.begin(), scenes.end(), std::uint64_t{0});
    return scenes;
}

void print(const CatalogueEntry& entry, const char* sources, const Outcome& outcome) {
    WARN(entry.id << ", " << sources << ": " << outcome.scenes << " scenes, " << outcome.met
                  << " met, " << outcome.broken << " above the target, worst " << outcome.worst
                  << " (scene " << outcome.worst_scene << ")");
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
    const Outcome outcome = search(entry, isotropic_scene, first_scenes(12), 4000);
    CHECK(outcome.met >= 8);
    CHECK(outcome.broken == 0);
}

// Scenes in which leaves passed although a search finds 0.104 to 0.134 in them: sources just beyond
// a face, cones that meet on one, the tip of a cone near a corner.
CASE_OF_EACH(entry, of_tensors(), "a promise is kept of scenes of tensors") {
    const Outcome outcome = search(entry, tensor_scene, {24, 29, 50, 73, 85, 91}, 94000);
    CHECK(outcome.met == outcome.scenes);
    CHECK(outcome.broken == 0);
}

CASE_OF_EACH(entry, nearly_of_tensors(), "a promise is nearly kept of scenes of tensors") {
    const Outcome outcome = search(entry, tensor_scene, first_scenes(4), 1000);
    CHECK(outcome.met >= 2);
    CHECK(outcome.worst <= 2 * target);
}

CASE_OF_EACH(entry, of_isotropic(), "all scenes of isotropic sources", "[.][promise]") {
    const Outcome outcome = search(entry, isotropic_scene, first_scenes(500), 20000);
    print(entry, "isotropic", outcome);
    CHECK(outcome.broken == 0);
}

CASE_OF_EACH(entry, of_tensors(), "all scenes of tensors", "[.][promise]") {
    const Outcome outcome = search(entry, tensor_scene, first_scenes(500), 94000);
    print(entry, "tensors", outcome);
    CHECK(outcome.broken == 0);
}

CASE_OF_EACH(entry, nearly_of_tensors(), "many scenes of tensors", "[.][promise]") {
    print(entry, "tensors", search(entry, tensor_scene, first_scenes(100), 4000));
}
