// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "controlspace/sources/cone.h"
#include "controlspace/sources/point_source.h"

namespace controlspace {

/// A source, and its place among those of all ranks.
struct Record {
    Point position;
    Metric metric;
    double growth;
    std::uint64_t index;

    PointSource source() const { return {position, metric, growth}; }
};

/// An isotropic one on its way between ranks.
struct LengthRecord {
    Point position;
    double length = 0, growth = 0;
    std::uint64_t index = 0;

    explicit LengthRecord(const Record& r)
        : position(r.position), length(r.metric.xx), growth(r.growth), index(r.index) {}
    LengthRecord() = default;
    explicit operator Record() const {
        return {position, Metric::isotropic(length), growth, index};
    }
};

inline double slope_of(const Record& r, double ratio) { return cone_growth(r.growth, ratio) - 1; }

inline std::vector<PointSource> sources_of(std::span<const Record> records) {
    std::vector<PointSource> sources;
    sources.reserve(records.size() + 1);
    for (const Record& r : records) sources.push_back(r.source());
    return sources;
}

}  // namespace controlspace
