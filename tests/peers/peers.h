// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <catch2/catch.hpp>
#include <memory>
#include <random>
#include <span>
#include <string>
#include <vector>

#include "baselines/peers/peer_rows.h"
#include "contract/structures_under_test.h"
#include "controlspace/baselines/catalogue.h"

namespace controlspace {

inline const CatalogueEntry& row_named(const std::string& id) {
    static const std::vector<CatalogueEntry> peers = peer_rows();
    const CatalogueEntry* found = find_entry(peers, id);
    return found != nullptr ? *found : *find_entry(structures(), id);
}

/// The finished structure `id` of the work's sources.
inline std::unique_ptr<ControlSpace> finished(const std::string& id, const Work& work,
                                              double ratio = 1.25) {
    SpaceOptions options = work.options();
    options.l_min = 0.5;
    const auto builder = row_named(id).make(options);
    builder->insert(work.sources);
    builder->grade({.ratio = ratio});
    return builder->build();
}

/// Places all over a box, and those of the work's sources.
inline std::vector<Point> places_in(const Work& work, int count = 2000) {
    std::mt19937_64 random(7);
    std::vector<Point> places;
    for (const PointSource& source : work.sources) places.push_back(source.position);
    for (int i = 0; i < count; ++i) {
        Point x = work.domain.low;
        for (Axis a = 0; a < 3; ++a) {
            x[a] += std::uniform_real_distribution<double>(0, 1)(random) * work.domain.edges()[a];
        }
        places.push_back(x);
    }
    return places;
}

inline std::vector<Metric> answers_at(const ControlSpace& space, std::span<const Point> x) {
    std::vector<Metric> metrics(x.size());
    space.sample(x, metrics);
    return metrics;
}
/// How many of two lists' items differ.
template <class Item>
std::size_t differing(const std::vector<Item>& a, const std::vector<Item>& b) {
    std::size_t count = 0;
    for (std::size_t i = 0; i < a.size(); ++i) count += a[i] == b[i] ? 0 : 1;
    return count;
}
inline std::vector<double> lengths_at(const ControlSpace& space, std::span<const Point> x) {
    std::vector<double> lengths(x.size());
    space.sample_lengths(x, lengths);
    return lengths;
}

}  // namespace controlspace
