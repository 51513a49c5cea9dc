#include "gradation/grade.h"

#include <fmt/format.h>

#include "error.h"
#include "gradation/passes.h"
#include "gradation/queue.h"

namespace controlspace {

void require_valid(const GradationOptions& options) {
    if (!std::isfinite(options.ratio) || options.ratio < 1) {
        throw InputError(fmt::format("gradation ratio g_r is {}: give a finite value of at least 1",
                                     options.ratio));
    }
}

double largest_gradation(const ControlGraph& graph, std::span<const Metric> metrics,
                         GradationLaw law) {
    double largest = 1;
    std::visit(
        [&](const auto& nodes) {
            for (NodeIndex i = 0; i < nodes.size(); ++i) {
                nodes.for_each_link(i, [&](NodeIndex j, const Vector& v) {
                    const Growth growth = growth_between(law, metrics[i], metrics[j], v);
                    largest = std::max(largest, growth.gradation());
                });
            }
        },
        graph);
    return largest;
}

GradationReport grade(const ControlGraph& graph, std::span<Metric> metrics,
                      const GradationOptions& options) {
    require_valid(options);
    GradationReport report;
    report.operations = std::visit(
        [&](const auto& nodes) {
            return options.schedule == GradationSchedule::queue
                       ? grade_by_queue(nodes, metrics, options.law, options.ratio)
                       : PassSchedule(nodes, metrics, options.law, options.ratio).run();
        },
        graph);
    report.largest_ratio_left = largest_gradation(graph, metrics, options.law);
    return report;
}

}  // namespace controlspace
