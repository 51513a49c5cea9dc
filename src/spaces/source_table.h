#pragma once

#include <cstdint>
#include <vector>

#include "metric/metric.h"
#include "sources/point_source.h"

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
    const Metric& metric(SourceIndex i) const { return metrics_[metric_of_[i]]; }
    PointSource source(SourceIndex i) const { return {position(i), metric(i)}; }

    /// The cone of source `i` at `x`: M (1 + (g-1) |M^-1 (x - Q)|).
    Metric cone(SourceIndex i, double g, const Point& x) const {
        const Metric& m = metric(i);
        const Vector v = x - positions_[i];
        if (is_isotropic(m)) return Metric::isotropic(m.xx + (g - 1) * v.norm());
        return (1 + (g - 1) * metric_length(m, v)) * m;
    }

    /// Keeps only the sources for which `kept` is not 0, in their order; returns the new index of
    /// each old one.
    std::vector<SourceIndex> keep(const std::vector<std::uint8_t>& kept);

    std::size_t bytes() const {
        return positions_.capacity() * sizeof(Point) + metrics_.capacity() * sizeof(Metric) +
               metric_of_.capacity() * sizeof(std::uint32_t);
    }
    void shrink_to_fit();

private:
    std::vector<Point> positions_;
    std::vector<std::uint32_t> metric_of_;
    std::vector<Metric> metrics_;
    bool all_isotropic_ = true;
};

}  // namespace controlspace
