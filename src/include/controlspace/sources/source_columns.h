// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "controlspace/geometry/point.h"
#include "controlspace/metric/metric.h"
#include "controlspace/sources/own_growths.h"
#include "controlspace/sources/point_source.h"

namespace controlspace {

/// Point sources as columns, where there are many: 32 bytes each as long as all are isotropic, 72
/// otherwise; 8 more where some have gradation ratios of their own. Copies share their memory until
/// one of them is added to.
class SourceColumns {
public:
    SourceColumns() : columns_(std::make_shared<Columns>()) {}
    /// There must be a length or a metric for each position, and a ratio or none.
    SourceColumns(std::vector<Point> positions, std::vector<double> lengths,
                  std::vector<Metric> metrics, OwnGrowths growths);

    void add(std::span<const PointSource> sources);
    void add(SourceColumns sources);

    std::size_t size() const { return columns_->positions.size(); }
    bool empty() const { return columns_->positions.empty(); }
    bool are_isotropic() const { return columns_->metrics.empty(); }
    PointSource operator[](std::size_t i) const {
        const Columns& c = *columns_;
        return {c.positions[i], c.metrics.empty() ? Metric::isotropic(c.lengths[i]) : c.metrics[i],
                c.growths[i]};
    }
    /// Those from `first` on, at most `count`, as an array.
    std::vector<PointSource> part(std::size_t first, std::size_t count) const;
    std::vector<PointSource> all() const { return part(0, size()); }

    const std::vector<Point>& positions() const { return columns_->positions; }
    /// One of them is empty: there are metrics if any is a tensor.
    const std::vector<double>& lengths() const { return columns_->lengths; }
    const std::vector<Metric>& metrics() const { return columns_->metrics; }
    const OwnGrowths& growths() const { return columns_->growths; }
    /// Bytes allocated.
    std::size_t bytes() const;

private:
    struct Columns {
        std::vector<Point> positions;
        std::vector<double> lengths;
        std::vector<Metric> metrics;
        OwnGrowths growths;
    };

    std::shared_ptr<Columns> columns_;
};

SourceColumns columns_of(std::span<const PointSource> sources);

/// Calls `use` with arrays of all of them, one after the other, where one array would take too much
/// memory.
template <class Use>
void for_each_part(const SourceColumns& sources, const Use& use) {
    constexpr std::size_t at_once = std::size_t{1} << 22;
    for (std::size_t i = 0; i < sources.size(); i += at_once) use(sources.part(i, at_once));
}

/// Smallest length that any of the sources requests in any direction. Throws InputError if there
/// are none.
double finest_length(const SourceColumns& sources);

}  // namespace controlspace
