#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "controlspace/gradation/law.h"
#include "controlspace/gradation/node_graph.h"
#include "controlspace/gradation/ordered_metrics.h"
#include "controlspace/metric/metric.h"

namespace controlspace {

/// In which order the law is applied to pairs of neighbours.
enum class GradationSchedule {
    /// Until nothing changes (paper §3.2): what is left is within the ratio asked for.
    queue,
    /// At most ten passes over the nodes that are still too steep, in tree order: what the paper's
    /// tables were made with. May leave pairs above the ratio.
    passes,
};

struct GradationOptions {
    GradationLaw law = GradationLaw::cone;
    GradationSchedule schedule = GradationSchedule::queue;
    double ratio = 1.25;  ///< g_r of the paper, >= 1
    /// `faces`, as in the paper, which for the passes of its tables means `nearest_per_face`; or
    /// `all`.
    Neighbourhood neighbourhood = Neighbourhood::faces;

    bool operator==(const GradationOptions&) const = default;
};

struct GradationReport {
    /// Metrics made smaller, each counted as often as that happened to it; but once where those of
    /// a NodeGraph are all isotropic, under the cone law and by the queue.
    std::uint64_t operations = 0;
    /// Over all neighbours, under the law that was applied. Where only what had changed was graded
    /// (gradation/regrade.h): over the nodes visited and all neighbours of the time before, so that
    /// it may be more than is left.
    double largest_ratio_left = 1;
    /// Where only what had changed was graded: how often a node's neighbours were looked at.
    std::optional<std::uint64_t> visits = std::nullopt;
};

/// The neighbours that are compared.
inline Neighbourhood neighbourhood_of(const GradationOptions& options) {
    if (options.neighbourhood == Neighbourhood::all) return Neighbourhood::all;
    return options.schedule == GradationSchedule::queue ? Neighbourhood::faces
                                                        : Neighbourhood::nearest_per_face;
}

/// Throws InputError for a ratio below 1 or not finite.
void require_valid(const GradationOptions& options);

/// The largest gradation ratio that neighbours show under `law`; 1 where all are alike.
double largest_gradation(const ControlGraph& graph, std::span<const Metric> metrics,
                         GradationLaw law);

/// Makes the metrics of the control nodes grow smoothly, in place; they only ever get smaller. On
/// all of TBB's threads, with a result that does not depend on their number.
/// `metrics.size()` must be the graph's size; for the queue, neighbours must be mutual. Throws as
/// require_valid does.
GradationReport grade(const ControlGraph& graph, OrderedMetrics metrics,
                      const GradationOptions& options);

}  // namespace controlspace
