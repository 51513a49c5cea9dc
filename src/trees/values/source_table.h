// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "controlspace/metric/metric.h"
#include "controlspace/sources/cone.h"
#include "controlspace/sources/own_growths.h"
#include "controlspace/sources/point_source.h"
#include "space/state.h"

namespace controlspace {

using SourceIndex = std::uint32_t;

/// Sources that a structure keeps, as flat arrays. Sources with the same metric as the one entered
/// before them share it.
class SourceTable {
public:
    SourceIndex add(const PointSource& source);

    std::size_t size() const { return positions_.size(); }
    const Point& position(SourceIndex i) const { return positions_[i]; }
    bool all_isotropic() const { return all_isotropic_; }
    /// Whether the ratio of all cones is that of the field.
    bool all_grow_alike() const { return growths_.empty(); }
    const Metric& metric(SourceIndex i) const { return metrics_[metric_of_[i]]; }
    std::vector<PointSource> all() const;
    PointSource source(SourceIndex i) const { return {position(i), metric(i), growths_[i]}; }

    /// The ratio of the cone of source `i`, in a field of ratio g.
    double growth(SourceIndex i, double g) const { return cone_growth(growths_[i], g); }
    /// The cone of source `i` at `x` is its metric times this: 1 + (g-1) |M^-1 (x - Q)|.
    double factor(SourceIndex i, double g, const Point& x) const {
        return 1 + (growth(i, g) - 1) * metric_length(metric(i), x - positions_[i]);
    }
    double smallest_length(SourceIndex i) const { return smallest_[metric_of_[i]]; }

    /// Keeps only the sources for which `kept` is not 0, in their order; returns the new index of
    /// each old one.
    std::vector<SourceIndex> keep(const std::vector<std::uint8_t>& kept);

    void save(StateWriter& state) const;
    void load(const StateReader& state);

    std::size_t bytes() const {
        return positions_.capacity() * sizeof(Point) + metrics_.capacity() * sizeof(Metric) +
               smallest_.capacity() * sizeof(double) + growths_.bytes() +
               metric_of_.capacity() * sizeof(std::uint32_t);
    }
    void shrink_to_fit();

private:
    std::vector<Point> positions_;
    std::vector<std::uint32_t> metric_of_;
    std::vector<Metric> metrics_;
    std::vector<double> smallest_;  // length of each metric
    OwnGrowths growths_;
    bool all_isotropic_ = true;
};

}  // namespace controlspace
