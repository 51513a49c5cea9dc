#include "gradation/grade.h"

#include <fmt/format.h>

#include "error.h"
#include "gradation/passes.h"
#include "gradation/queue.h"

namespace controlspace {

namespace {

template <class Graph>
double largest_ratio(const Graph& graph, std::span<const Metric> metrics, GradationLaw law) {
    double largest = 1;
    for (NodeIndex i = 0; i < graph.size(); ++i) {
        const Point p = graph.position(i);
        graph.for_each_neighbour(i, [&](NodeIndex j) {
            const Vector v = graph.position(j) - p;
            largest = std::max(largest, growth_between(law, metrics[i], metrics[j], v).gradation());
        });
    }
    return largest;
}

}  // namespace

GradationReport grade(const ControlGraph& graph, std::span<Metric> metrics,
                      const GradationOptions& options) {
    if (!std::isfinite(options.ratio) || options.ratio < 1) {
        throw InputError(fmt::format("gradation ratio g_r is {}: give a finite value of at least 1",
                                     options.ratio));
    }
    return std::visit(
        [&](const auto& g) {
            GradationReport report;
            report.operations = options.schedule == GradationSchedule::queue
                                    ? grade_by_queue(g, metrics, options.law, options.ratio)
                                    : PassSchedule(g, metrics, options.law, options.ratio).run();
            report.largest_ratio_left = largest_ratio(g, metrics, options.law);
            return report;
        },
        graph);
}

}  // namespace controlspace
