#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "controlspace/sources/cone.h"
#include "controlspace/sources/point_source.h"

namespace controlspace {

/// An isotropic source on its way between ranks.
struct Record {
    Point position;
    double length, growth;
    std::uint64_t index;  ///< among those of all ranks

    PointSource source() const { return {position, Metric::isotropic(length), growth}; }
};

inline double slope_of(const Record& r, double ratio) { return cone_growth(r.growth, ratio) - 1; }

inline std::vector<PointSource> sources_of(std::span<const Record> records) {
    std::vector<PointSource> sources;
    sources.reserve(records.size() + 1);
    for (const Record& r : records) sources.push_back(r.source());
    return sources;
}

}  // namespace controlspace
