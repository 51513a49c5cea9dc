// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <catch2/catch.hpp>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "baselines/fixtures.h"
#include "controlspace/measure/access_time.h"

namespace controlspace::tiles_scenes {

inline constexpr double g = 1.25;

inline std::unique_ptr<ControlSpace> adapted(const std::string& id, const SpaceOptions& options,
                                             std::span<const PointSource> sources, double target,
                                             std::optional<Precision> precision) {
    const auto builder = structure_with_id(id).make(options);
    AdaptationGoal goal{sources, nullptr, g, target};
    goal.precision = precision.value_or(Precision::doubles);
    REQUIRE(builder->adapt(goal).met);
    return builder->build({.precision = precision});
}

// Cubes, oblong boxes, those away from the origin, flat ones, tiny ones.
struct Scene {
    Box domain;
    std::vector<PointSource> sources;
};
inline Scene scene(int number) {
    const Box boxes[] = {{Point(-1, -1, -1), Point(1, 1, 1)},
                         {Point(3, -2, 7), Point(11, -0.9, 8.3)},
                         {Point(5e5, 4e6, 0), Point(5.1e5, 4.01e6, 0)},
                         {Point(1e-7, 0, 0), Point(2e-7, 3e-8, 1e-7)}};
    Scene scene{boxes[number], {}};
    const Vector edges = scene.domain.edges();
    for (const Point& place : random_points(scene.domain, 20, 5)) {
        const double h = edges.maxCoeff() * (scene.sources.size() % 2 == 0 ? 0.01 : 0.04);
        scene.sources.push_back({place, Metric::isotropic(h)});
    }
    return scene;
}

}  // namespace controlspace::tiles_scenes
