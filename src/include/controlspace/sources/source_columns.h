#pragma once

#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "controlspace/geometry/point.h"
#include "controlspace/metric/metric.h"
#include "controlspace/sources/own_growths.h"
#include "controlspace/sources/point_source.h"

namespace controlspace {

/// Point sources as columns, where there are many: 32 bytes each as long as all are isotropic, 72
/// otherwise; 8 more where some have gradation ratios of their own.
class SourceColumns {
public:
    SourceColumns() = default;
    /// There must be a length or a metric for each position, and a ratio or none.
    SourceColumns(std::vector<Point> positions, std::vector<double> lengths,
                  std::vector<Metric> metrics, OwnGrowths growths)
        : positions_(std::move(positions)),
          lengths_(std::move(lengths)),
          metrics_(std::move(metrics)),
          growths_(std::move(growths)) {}

    void add(std::span<const PointSource> sources);

    std::size_t size() const { return positions_.size(); }
    bool empty() const { return positions_.empty(); }
    bool are_isotropic() const { return metrics_.empty(); }
    PointSource operator[](std::size_t i) const {
        return {positions_[i], metrics_.empty() ? Metric::isotropic(lengths_[i]) : metrics_[i],
                growths_[i]};
    }
    /// Those from `first` on, at most `count`.
    std::vector<PointSource> part(std::size_t first, std::size_t count) const;
    std::vector<PointSource> all() const { return part(0, size()); }

    const std::vector<Point>& positions() const { return positions_; }
    /// One of them is empty: there are metrics if any is a tensor.
    const std::vector<double>& lengths() const { return lengths_; }
    const std::vector<Metric>& metrics() const { return metrics_; }
    const OwnGrowths& growths() const { return growths_; }
    /// Bytes allocated.
    std::size_t bytes() const;

private:
    std::vector<Point> positions_;
    std::vector<double> lengths_;
    std::vector<Metric> metrics_;
    OwnGrowths growths_;
};

SourceColumns columns_of(std::span<const PointSource> sources);

/// Smallest length that any of the sources requests in any direction. Throws InputError if there
/// are none.
double finest_length(const SourceColumns& sources);

}  // namespace controlspace
