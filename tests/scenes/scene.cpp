// SPDX-License-Identifier: Apache-2.0
#include "scenes/scene.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

#include "controlspace/baselines/catalogue.h"
#include "geometry/random_fractions.h"

namespace controlspace {
namespace {

class Draw {
public:
    explicit Draw(std::uint64_t seed) : fraction_(seed) {}

    double real(double low, double high) { return low + fraction_() * (high - low); }
    double logarithmic(double low, double high) {
        return std::exp(real(std::log(low), std::log(high)));
    }
    int whole(int low, int high) {
        return std::min(high, low + static_cast<int>(fraction_() * (high - low + 1)));
    }
    bool once_in(int n) { return whole(1, n) == 1; }
    template <std::size_t n>
    auto one_of(const auto(&values)[n]) {
        return values[static_cast<std::size_t>(whole(0, static_cast<int>(n) - 1))];
    }
    Point in(const Box& box) {
        Point p;
        for (Axis a = 0; a < 3; ++a) p[a] = real(box.low[a], box.high[a]);
        return p;
    }
    Eigen::Matrix3d frame() {
        return (Eigen::AngleAxisd(real(0, 3), Vector::UnitX()) *
                Eigen::AngleAxisd(real(0, 3), Vector::UnitY()) *
                Eigen::AngleAxisd(real(0, 3), Vector::UnitZ()))
            .toRotationMatrix();
    }

private:
    RandomFractions fraction_;
};

Box domain(Draw& draw, std::string& name) {
    const char* const shapes[] = {"cube", "cube", "oblong", "thin", "flat"};
    const std::string shape = draw.one_of(shapes);
    const double size = draw.once_in(3) ? draw.logarithmic(1e-3, 1e3) : 1;
    Vector edges = Vector::Constant(size);
    if (shape != "cube") edges[draw.whole(0, 2)] *= draw.real(1, 3);
    if (shape == "thin") edges[draw.whole(0, 2)] *= draw.logarithmic(1e-3, 0.3);
    if (shape == "flat") edges[draw.whole(0, 2)] = 0;
    Vector low = -edges / 2;
    if (draw.once_in(3)) low += size * Vector(draw.real(-1e3, 1e3), draw.real(-9, 9), 0.1);
    name += shape + (size == 1 ? "" : ", scaled");
    return {low, low + edges};
}

Point position(Draw& draw, const std::string& arrangement, const Box& box, const Point& centre,
               const std::vector<PointSource>& before) {
    const Vector edges = box.edges();
    Point p = draw.in(box);
    if (arrangement == "clustered") {
        p = centre + 0.02 * (p - box.centre());
    } else if (arrangement == "coplanar") {
        p[draw.once_in(8) ? 1 : 0] = centre[0];
    } else if (arrangement == "collinear") {
        p = centre + draw.real(-0.4, 0.4) * edges;
    } else if (arrangement == "on faces") {
        for (Axis a = 0; a < 3; ++a) {
            if (draw.once_in(2)) p[a] = draw.once_in(2) ? box.low[a] : box.high[a];
        }
    } else if (arrangement == "next to cuts") {
        // Halves, quarters and eighths of the domain, and a hair beside.
        for (Axis a = 0; a < 3; ++a) {
            const double hairs[] = {0.0, 1e-15, -1e-15, 1e-9, -1e-9, 1e-4, -1e-4};
            const double at = draw.whole(0, 8) / 8.0 + draw.one_of(hairs);
            p[a] = box.low[a] + at * edges[a];
        }
    } else if (arrangement == "duplicate" && !before.empty() && draw.once_in(2)) {
        p = before[static_cast<std::size_t>(draw.whole(0, static_cast<int>(before.size()) - 1))]
                .position;
    }
    return p.cwiseMax(box.low).cwiseMin(box.high);
}

}  // namespace

bool Scene::is_isotropic() const {
    return std::ranges::all_of(
        sources, [](const PointSource& s) { return controlspace::is_isotropic(s.metric); });
}

bool Scene::has_own_ratios() const {
    return std::ranges::any_of(sources, [](const PointSource& s) { return s.growth != 0; });
}

Scene random_scene(std::uint64_t seed) {
    Draw draw(seed);
    Scene scene;
    scene.options.domain = domain(draw, scene.name);
    const Box& box = scene.options.domain;
    const char* const arrangements[] = {"anywhere", "clustered",    "coplanar", "collinear",
                                        "on faces", "next to cuts", "duplicate"};
    const std::string arrangement = draw.one_of(arrangements);
    const int kind = draw.whole(0, 3);  // 0 and 1: isotropic
    const double anisotropy = kind < 2 ? 1 : draw.logarithmic(2, kind == 2 ? 10 : 1e4);
    const double coarse = box.edges().maxCoeff() * draw.logarithmic(0.03, 0.5);
    const bool own_growths = draw.once_in(5);
    const Point centre = draw.in(box);
    const int count = draw.once_in(4) ? 1 : draw.whole(2, 60);
    for (int i = 0; i < count; ++i) {
        PointSource source;
        source.position = position(draw, arrangement, box, centre, scene.sources);
        const double h = coarse * draw.logarithmic(0.3, 1);
        source.metric = Metric::isotropic(h);
        if (kind >= 2 && !draw.once_in(5)) {
            const std::array lengths{h / anisotropy, h * draw.logarithmic(1 / anisotropy, 1), h};
            source.metric = metric_from_frame(
                lengths,
                draw.once_in(4) ? Eigen::Matrix3d(Eigen::Matrix3d::Identity()) : draw.frame());
        }
        if (own_growths && draw.once_in(2)) source.growth = draw.real(1, 2);
        scene.sources.push_back(source);
    }
    scene.name += ", " + arrangement + (kind < 2 ? ", isotropic" : ", tensors") +
                  (own_growths ? ", ratios of their own" : "");

    const double ratios[] = {1.001, 1.1, 1.25, 1.25, 1.5, 2.0, 10.0};
    const double tolerances[] = {0.2, 0.2, 0.01, 1.0};
    scene.options.ratio = draw.one_of(ratios);
    scene.options.tolerance = draw.one_of(tolerances);
    scene.options.l_min = draw.logarithmic(0.5, 4);
    scene.options.octree_depth = draw.whole(1, 5);
    scene.options.kd_depth = draw.whole(1, 15);
    scene.options.finest_length = finest_length(scene.sources);
    scene.options.voxel = box.edges().maxCoeff() / draw.whole(3, 20);
    if (draw.once_in(5)) scene.options.h_max = coarse;
    if (draw.once_in(4)) scene.options.intersection = IntersectionRule::in_turn;
    const SplitRule rules[] = {SplitRule::middle, SplitRule::golden, SplitRule::metric};
    scene.options.split = draw.one_of(rules);
    const GradationLaw laws[] = {GradationLaw::cone, GradationLaw::mean_length};
    scene.from_node_to_node = {.law = draw.one_of(laws),
                               .schedule = GradationSchedule::queue,
                               .ratio = scene.options.ratio};
    if (draw.once_in(2)) scene.from_node_to_node.neighbourhood = Neighbourhood::all;
    return scene;
}

std::vector<Point> places_in(const Scene& scene, std::uint64_t seed) {
    Draw draw(seed);
    const Box& box = scene.options.domain;
    std::vector<Point> places;
    for (int i = 0; i < 100; ++i) places.push_back(draw.in(box));
    for (int i = 0; i < 27; ++i) {
        const Vector at(i % 3, i / 3 % 3, i / 9);
        places.push_back(box.low + (at / 2).cwiseProduct(box.edges()));
    }
    for (const PointSource& source : scene.sources) {
        places.push_back(source.position);
        for (Axis a = 0; a < 3; ++a) {
            Point p = source.position;
            p[a] += (draw.once_in(2) ? 1 : -1) * box.edges()[a] * draw.logarithmic(1e-12, 0.1);
            places.push_back(p.cwiseMax(box.low).cwiseMin(box.high));
        }
    }
    return places;
}

}  // namespace controlspace
