// SPDX-License-Identifier: Apache-2.0
#include "controlspace/sources/source_columns.h"

#include <algorithm>
#include <atomic>
#include <utility>

#include "refuse.h"

namespace controlspace {

SourceColumns::SourceColumns(std::vector<Point> positions, std::vector<double> lengths,
                             std::vector<Metric> metrics, OwnGrowths growths)
    : columns_(std::make_shared<Columns>(Columns{std::move(positions), std::move(lengths),
                                                 std::move(metrics), std::move(growths)})) {}

void SourceColumns::add(std::span<const PointSource> sources) {
    if (columns_.use_count() > 1) {
        columns_ = std::make_shared<Columns>(*columns_);
    } else {
        // What the last of those that shared them has read, perhaps in another thread, is behind
        // us.
        std::atomic_thread_fence(std::memory_order_acquire);
    }
    auto& [positions, lengths, metrics, growths] = *columns_;
    const bool are_lengths = metrics.empty() && all_isotropic(sources);
    if (!are_lengths && metrics.empty()) {
        for (const double h : lengths) metrics.push_back(Metric::isotropic(h));
        lengths = std::vector<double>();  // its memory too
    }
    if (positions.empty()) {
        positions.reserve(sources.size());
        are_lengths ? lengths.reserve(sources.size()) : metrics.reserve(sources.size());
    }
    for (const PointSource& source : sources) {
        growths.add(positions.size(), source.growth);
        positions.push_back(source.position);
        if (are_lengths) {
            lengths.push_back(source.metric.xx);
        } else {
            metrics.push_back(source.metric);
        }
    }
}

void SourceColumns::add(SourceColumns sources) {
    if (empty()) {
        *this = std::move(sources);
        return;
    }
    for_each_part(sources, [&](std::span<const PointSource> part) { add(part); });
}

std::vector<PointSource> SourceColumns::part(std::size_t first, std::size_t count) const {
    std::vector<PointSource> sources(std::min(count, size() - first));
    for (std::size_t i = 0; i < sources.size(); ++i) sources[i] = (*this)[first + i];
    return sources;
}

std::size_t SourceColumns::bytes() const {
    const Columns& c = *columns_;
    return c.positions.capacity() * sizeof(Point) + c.lengths.capacity() * sizeof(double) +
           c.metrics.capacity() * sizeof(Metric) + c.growths.bytes();
}

SourceColumns columns_of(std::span<const PointSource> sources) {
    SourceColumns columns;
    columns.add(sources);
    return columns;
}

double finest_length(const SourceColumns& sources) {
    if (!sources.are_isotropic()) return finest_length(sources.all());
    if (sources.empty()) refuse("no sources: give at least one");
    return std::ranges::min(sources.lengths());
}

}  // namespace controlspace
