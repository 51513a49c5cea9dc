// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>

#include "controlspace/gradation/law.h"
#include "controlspace/gradation/node_graph.h"
#include "controlspace/gradation/ordered_metrics.h"
#include "controlspace/metric/metric.h"

namespace controlspace {

/// Where control nodes get their graded metrics from.
enum class GradationSchedule {
    /// From neighbour to neighbour until nothing changes (paper §3.2): no pair exceeds the ratio.
    queue,
    /// At most ten passes over the nodes that are still too steep, in tree order: what the paper's
    /// tables were made with. May leave pairs above the ratio.
    passes,
    /// By the sources: the exact field of all that the builder was given (measure/reference.h).
    /// Nothing is handed on from node to node. Where the field at a node is more than twice as long
    /// as a source in its cell requests, since the cell is too coarse, the request is kept.
    /// By the queue where that is not possible: under the mean-length law; for a field that was
    /// assigned or adapted (SpaceOptions::takes_later_sources adapts it again); in a builder that
    /// was loaded without its sources; and in `grade`.
    sources,
};

struct GradationOptions {
    GradationLaw law = GradationLaw::cone;
    GradationSchedule schedule = GradationSchedule::sources;
    double ratio = 1.25;  ///< g_r of the paper, 1 to 1e50
    /// `faces`, as in the paper, which for the passes of its tables means `nearest_per_face`; or
    /// `all`.
    Neighbourhood neighbourhood = Neighbourhood::faces;

    bool operator==(const GradationOptions&) const = default;
};

struct GradationReport {
    /// Metrics made smaller, each counted every time. By the sources: once each.
    std::uint64_t operations = 0;
    /// Largest gradation ratio over all neighbours, under the law that was applied. By the sources
    /// it is not evaluated, and stays 1: see largest_gradation.
    double largest_ratio_left = 1;
};

/// The neighbours that are compared under these options.
inline Neighbourhood neighbourhood_of(const GradationOptions& options) {
    if (options.neighbourhood == Neighbourhood::all) return Neighbourhood::all;
    return options.schedule == GradationSchedule::passes ? Neighbourhood::nearest_per_face
                                                         : Neighbourhood::faces;
}

/// Throws InputError for a ratio below 1 or not finite, and for an unknown law, schedule or
/// neighbourhood.
void require_valid(const GradationOptions& options);

/// The largest gradation ratio between neighbours under `law`; 1 if all metrics are alike. Throws
/// InputError for an unknown law.
double largest_gradation(const ControlGraph& graph, std::span<const Metric> metrics,
                         GradationLaw law);

/// Gradation (paper §3.2): limits the growth of the control nodes' metrics to the ratio, in place;
/// no metric gets larger. Runs on one thread. `metrics.size()` must be the graph's size; for the
/// queue, neighbours must be mutual. Throws as require_valid does.
GradationReport grade(const ControlGraph& graph, OrderedMetrics metrics,
                      const GradationOptions& options);

}  // namespace controlspace
