// SPDX-License-Identifier: Apache-2.0
#include "trees/values/source_table.h"

#include <algorithm>

#include "space/given_sources.h"

namespace controlspace {

SourceIndex SourceTable::add(const PointSource& source) {
    if (metrics_.empty() || metrics_.back() != source.metric) {
        metrics_.push_back(source.metric);
        smallest_.push_back(eigen_frame(source.metric).lengths[0]);
    }
    all_isotropic_ = all_isotropic_ && is_isotropic(source.metric);
    growths_.add(positions_.size(), source.growth);
    positions_.push_back(source.position);
    metric_of_.push_back(static_cast<std::uint32_t>(metrics_.size() - 1));
    return static_cast<SourceIndex>(positions_.size() - 1);
}

std::vector<PointSource> SourceTable::all() const {
    std::vector<PointSource> sources;
    sources.reserve(size());
    for (SourceIndex i = 0; i < size(); ++i) sources.push_back(source(i));
    return sources;
}

std::vector<SourceIndex> SourceTable::keep(const std::vector<std::uint8_t>& kept) {
    std::vector<SourceIndex> renamed(size());
    SourceTable table;
    for (SourceIndex i = 0; i < size(); ++i) {
        if (kept[i] != 0) renamed[i] = table.add(source(i));
    }
    table.shrink_to_fit();
    *this = std::move(table);
    return renamed;
}

void SourceTable::save(StateWriter& state) const {
    state("sources.positions", positions_);
    state("sources.metric_of", metric_of_);
    state("sources.metrics", metrics_);
    save_growths(state, "sources", growths_);
}

void SourceTable::load(const StateReader& state) {
    std::vector<Point> positions;
    std::vector<std::uint32_t> metric_of;
    std::vector<Metric> metrics;
    state("sources.positions", positions);
    state("sources.metric_of", metric_of);
    state("sources.metrics", metrics);
    const auto is_place = [](const Point& x) { return std::ranges::all_of(x, is_coordinate); };
    state.require(all_are(positions, is_place), "sources.positions", "holds what is no place");
    state.require(metric_of.size() == positions.size(), "sources.metric_of", "has another length");
    require_below(state, "sources.metric_of", metric_of, metrics.size());
    require_metrics(state, "sources.metrics", metrics);
    const OwnGrowths growths = load_growths(state, "sources", positions.size());
    *this = {};
    for (std::size_t i = 0; i < positions.size(); ++i) {
        add({positions[i], metrics[metric_of[i]], growths[i]});
    }
    shrink_to_fit();
}

void SourceTable::shrink_to_fit() {
    positions_.shrink_to_fit();
    metric_of_.shrink_to_fit();
    metrics_.shrink_to_fit();
    smallest_.shrink_to_fit();
    growths_.shrink_to_fit();
}

}  // namespace controlspace
