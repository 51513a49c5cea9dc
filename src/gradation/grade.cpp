// SPDX-License-Identifier: Apache-2.0
#include "controlspace/gradation/grade.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>

#include <functional>

#include "controlspace/error.h"
#include "controlspace/geometry/point.h"
#include "geometry/large_pages.h"
#include "geometry/threads.h"
#include "gradation/schedules.h"
#include "require_known.h"

namespace controlspace {

void require_valid(const GradationOptions& options) {
    if (!(options.ratio >= 1 && options.ratio <= largest_magnitude)) {
        throw InputError(fmt::format("gradation ratio g_r is {}: give a value of 1 to {}",
                                     options.ratio, largest_magnitude));
    }
    require_known("the law of gradation", options.law, GradationLaw::mean_length);
    require_known("the schedule of gradation", options.schedule, GradationSchedule::sources);
    require_known("the neighbourhood", options.neighbourhood, Neighbourhood::all);
}

namespace {

// Returns the number of metrics made smaller.
template <class Graph>
std::uint64_t grade_sizes(const Graph& graph, OrderedMetrics metrics, double g) {
    std::vector<double> sizes = large_array<double>(metrics.size());
    constexpr std::size_t nodes_per_task = 4096;
    using Range = tbb::blocked_range<std::size_t>;
    const Range all(0, sizes.size(), nodes_per_task);
    tbb::parallel_for(all, [&](const Range& range) {
        for (std::size_t i = range.begin(); i < range.end(); ++i) sizes[i] = metrics[i].xx;
    });
    grade_in_rounds(graph, std::span(sizes), g);
    return tbb::parallel_reduce(
        all, std::uint64_t{0},
        [&](const Range& range, std::uint64_t operations) {
            for (std::size_t i = range.begin(); i < range.end(); ++i) {
                if (sizes[i] == metrics[i].xx) continue;
                metrics[i] = Metric::isotropic(sizes[i]);
                ++operations;
            }
            return operations;
        },
        std::plus<>());
}

template <class Graph>
std::uint64_t grade_nodes(const Graph& graph, OrderedMetrics metrics,
                          const GradationOptions& options) {
    const Grading<Graph> grading{graph, metrics, options.law, options.ratio};
    if (options.schedule == GradationSchedule::passes) return grade_by_passes(grading);
    const auto all = metrics.all();
    const bool isotropic = std::all_of(all.begin(), all.end(), is_isotropic);
    if (isotropic && options.law == GradationLaw::cone) {
        return grade_sizes(graph, metrics, options.ratio);
    }
    if (!isotropic && threads_allowed() > 1) return grade_in_levels(grading);
    return grade_by_queue(grading);
}

// Metrics may be a span, or OrderedMetrics.
template <class Metrics>
double largest_gradation_of(const ControlGraph& graph, const Metrics& metrics, GradationLaw law) {
    constexpr std::size_t nodes_per_task = 1024;
    const auto largest_among = [&](const auto& nodes, const auto& range, double largest) {
        for (NodeIndex i = range.begin(); i < range.end(); ++i) {
            const Metric& from = metrics[i];
            nodes.for_each_link(i, [&](NodeIndex j, const Vector& v) {
                largest = std::max(largest, gradation_between(law, from, metrics[j], v));
            });
        }
        return largest;
    };
    return std::visit(
        [&](const auto& nodes) {
            using Range = tbb::blocked_range<NodeIndex>;
            return tbb::parallel_reduce(
                Range(0, static_cast<NodeIndex>(nodes.size()), nodes_per_task), 1.0,
                [&](const Range& range, double largest) {
                    return largest_among(nodes, range, largest);
                },
                [](double a, double b) { return std::max(a, b); });
        },
        graph);
}

}  // namespace

double largest_gradation(const ControlGraph& graph, std::span<const Metric> metrics,
                         GradationLaw law) {
    require_known("the law of gradation", law, GradationLaw::mean_length);
    return largest_gradation_of(graph, metrics, law);
}

GradationReport grade(const ControlGraph& graph, OrderedMetrics metrics,
                      const GradationOptions& options) {
    require_valid(options);
    GradationReport report;
    report.operations =
        std::visit([&](const auto& nodes) { return grade_nodes(nodes, metrics, options); }, graph);
    report.largest_ratio_left = largest_gradation_of(graph, metrics, options.law);
    return report;
}

}  // namespace controlspace
