// SPDX-License-Identifier: Apache-2.0
// Works for structures of OpenVDB that hold an octree.
#pragma once

#include <algorithm>
#include <catch2/catch.hpp>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "baselines/fixtures.h"
#include "controlspace/measure/access_time.h"

namespace controlspace::octree_scenes {

inline constexpr double g = 1.25;

struct Scene {
    Box domain;
    std::vector<PointSource> sources;

    SpaceOptions options() const { return {.domain = domain, .finest_length = 1}; }
    /// The exact field.
    double exact(const Point& x) const {
        double h = domain.half_diagonal();
        for (const PointSource& s : sources) {
            h = std::min(h, s.metric.xx + (g - 1) * (x - s.position).norm());
        }
        return h;
    }
    /// Of a structure, adapted with a proof.
    std::unique_ptr<ControlSpaceBuilder> builder(const std::string& id, double target,
                                                 Precision precision) const {
        auto builder = structure_with_id(id).make(options());
        AdaptationGoal goal{sources, nullptr, g, target};
        goal.precision = precision;
        const AdaptationReport report = builder->adapt(goal);
        REQUIRE(report.met);
        REQUIRE(report.is_bound);
        return builder;
    }
    std::unique_ptr<ControlSpace> adapted(const std::string& id, double target,
                                          std::optional<Precision> precision) const {
        return builder(id, target, precision.value_or(Precision::doubles))
            ->build({.precision = precision});
    }
};

/// A cube, an oblong box away from the origin, a flat one, a tiny one.
inline Scene scene(int number) {
    const Box boxes[] = {{Point(-1, -1, -1), Point(1, 1, 1)},
                         {Point(3, -2, 7), Point(11, -0.9, 8.3)},
                         {Point(5e5, 4e6, 0), Point(5.1e5, 4.01e6, 0)},
                         {Point(-1e-7, 2e-7, 0), Point(1e-7, 3e-7, 2e-7)}};
    Scene scene{boxes[number], {}};
    const Vector edges = scene.domain.edges();
    for (const Point& place : random_points(scene.domain, 20, 5)) {
        const double h = edges.maxCoeff() * (scene.sources.size() % 2 == 0 ? 0.01 : 0.04);
        scene.sources.push_back({place, Metric::isotropic(h)});
    }
    return scene;
}

/// Its finest leaves are less than 1 / 4096 of the domain.
inline Scene far_below_the_root() {
    return {{Point(0, 0, 0), Point(1e5, 1e5, 1e5)},
            {{Point(2e4, 3e4, 4e4), Metric::isotropic(1)},
             {Point(9e4, 8e4, 7e4), Metric::isotropic(1)}}};
}

}  // namespace controlspace::octree_scenes
