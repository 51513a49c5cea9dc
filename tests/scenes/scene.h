// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "controlspace/gradation/grade.h"
#include "controlspace/space/catalogue.h"

namespace controlspace {

/// A small scene drawn at random: 1 to 60 sources in an unfriendly arrangement, in a domain that
/// may be oblong, flat or far from the origin, and the settings of a structure, the rule by which
/// kd-trees cut among them. The same for the same seed on every machine.
struct Scene {
    std::string name;  ///< how its parts were drawn
    std::vector<PointSource> sources;
    SpaceOptions options;
    GradationOptions from_node_to_node;  ///< by the queue, with a law and neighbours that are drawn

    bool is_isotropic() const;
    bool has_own_ratios() const;
    GradationOptions gradation() const { return {.ratio = options.ratio}; }
};

Scene random_scene(std::uint64_t seed);

/// Where answers are judged: at random places, at the sources, next to them across each axis by
/// distances from 1e-12 to 0.1 of the domain, and at corners and on faces of the domain.
std::vector<Point> places_in(const Scene& scene, std::uint64_t seed);

}  // namespace controlspace
