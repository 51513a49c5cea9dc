// SPDX-License-Identifier: Apache-2.0
#include "measure/source_summary.h"

#include <algorithm>
#include <limits>
#include <numeric>
#include <vector>

#include "controlspace/gradation/grade.h"
#include "geometry/extent_of.h"
#include "geometry/point_order.h"
#include "measure/nearest.h"
#include "refuse.h"

namespace controlspace {
namespace {

constexpr std::size_t near_sources = 6;

/// The smallest source at each place, and how many share their place with a different one.
struct DistinctPlaces {
    std::vector<Point> positions;
    std::vector<Metric> metrics;
    std::size_t contradictory = 0;
};

DistinctPlaces distinct_places(std::span<const PointSource> sources) {
    std::vector<std::size_t> order(sources.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(), [&](std::size_t i, std::size_t j) {
        return precedes(sources[i].position, sources[j].position);
    });
    DistinctPlaces places;
    for (std::size_t first = 0, last = 0; first < order.size(); first = last) {
        const auto& [position, metric, growth] = sources[order[first]];
        places.positions.push_back(position);
        places.metrics.push_back(metric);
        bool all_alike = true;
        double shortest = mean_length(metric);
        for (last = first + 1; last < order.size(); ++last) {
            const PointSource& source = sources[order[last]];
            if (source.position != position) break;
            all_alike = all_alike && source.metric == metric;
            const double length = mean_length(source.metric);
            if (length < shortest) places.metrics.back() = source.metric;
            shortest = std::min(shortest, length);
        }
        if (!all_alike) places.contradictory += last - first;
    }
    return places;
}

}  // namespace

LengthSummary summarise_lengths(std::span<const Metric> metrics) {
    if (metrics.empty()) return {};
    LengthSummary summary;
    summary.count = metrics.size();
    summary.finest = std::numeric_limits<double>::infinity();
    double sum = 0;
    for (const Metric& metric : metrics) {
        summary.isotropic += is_isotropic(metric) ? 1 : 0;
        const auto lengths = eigen_frame(metric).lengths;
        summary.finest = std::min(summary.finest, lengths[0]);
        summary.coarsest = std::max(summary.coarsest, lengths[2]);
        summary.anisotropy = std::max(summary.anisotropy, lengths[2] / lengths[0]);
        sum += mean_length(metric);
    }
    summary.mean = sum / static_cast<double>(metrics.size());
    return summary;
}

SourceSummary summarise(std::span<const PointSource> sources) {
    if (sources.empty()) refuse("there are no sources: give one at least");
    SourceSummary summary;
    const DistinctPlaces places = distinct_places(sources);
    summary.contradictory = places.contradictory;
    summary.extent = extent_of(places.positions);
    std::vector<Metric> metrics;
    for (const auto& [position, metric, growth] : sources) {
        metrics.push_back(metric);
        if (growth > 0) {
            summary.least_growth =
                summary.own_growths++ > 0 ? std::min(summary.least_growth, growth) : growth;
            summary.most_growth = std::max(summary.most_growth, growth);
        }
    }
    static_cast<LengthSummary&>(summary) = summarise_lengths(metrics);
    summary.gradation = largest_gradation(nearest_neighbours(places.positions, near_sources),
                                          places.metrics, GradationLaw::cone);
    return summary;
}

}  // namespace controlspace
