// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <memory>
#include <random>
#include <span>
#include <string>
#include <vector>

#include "controlspace/baselines/catalogue.h"
#include "editable_space.h"

namespace controlspace {

/// The structures with a lattice of nodes.
inline std::span<const CatalogueEntry> grids() {
    static const std::vector<CatalogueEntry> all = [] {
        std::vector<CatalogueEntry> lattices;
        std::copy_if(structures().begin(), structures().end(), std::back_inserter(lattices),
                     [](const CatalogueEntry& entry) {
                         return entry.has<VoxelSize>() && !is_rounding(entry);
                     });
        return lattices;
    }();
    return all;
}

inline const CatalogueEntry& structure_with_id(const std::string& id) {
    return *std::find_if(structures().begin(), structures().end(),
                         [&](const CatalogueEntry& entry) { return entry.id == id; });
}

/// A new one that can be changed and read in turn.
inline std::unique_ptr<EditableSpace> make_structure(const std::string& id,
                                                     const SpaceOptions& options) {
    return editable(structure_with_id(id).make(options));
}

/// 40 x 26 x 18 cells, none of them a cube or a whole number of OpenVDB's leaves.
inline SpaceOptions small_grid() {
    SpaceOptions options;
    options.domain = {Point(-1, -1, 2), Point(1, 0.28, 2.89)};
    options.l_min = 0.5;
    options.finest_length = 0.1;
    return options;
}

inline double between(std::mt19937_64& random, double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
}

inline Point random_point(std::mt19937_64& random, const Box& box) {
    Point x;
    for (Axis a = 0; a < 3; ++a) x[a] = between(random, box.low[a], box.high[a]);
    return x;
}

/// Lengths between `shortest` and ten times that, in a random frame.
inline Metric random_metric(std::mt19937_64& random, double shortest) {
    std::normal_distribution<double> normal;
    const auto next = [&] { return normal(random); };
    const double w = next(), x = next(), y = next(), z = next();
    const auto length = [&] { return shortest * std::pow(10, between(random, 0, 1)); };
    const double a = length(), b = length(), c = length();
    return metric_from_frame({a, b, c}, Eigen::Quaterniond(w, x, y, z).normalized().matrix());
}

inline std::vector<PointSource> random_sources(std::size_t n, const SpaceOptions& options) {
    std::mt19937_64 random(7);
    std::vector<PointSource> sources;
    for (std::size_t i = 0; i < n; ++i) {
        const Point x = random_point(random, options.domain);
        sources.push_back({x, random_metric(random, options.finest_length)});
    }
    return sources;
}

/// Largest difference of two entries.
inline double difference(const Metric& a, const Metric& b) {
    return (a.matrix() - b.matrix()).cwiseAbs().maxCoeff();
}

inline std::vector<Metric> sample(const ControlSpace& space, std::span<const Point> x) {
    std::vector<Metric> out(x.size());
    space.sample(x, out);
    return out;
}

}  // namespace controlspace
