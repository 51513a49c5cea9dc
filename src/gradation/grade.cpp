// SPDX-License-Identifier: Apache-2.0
#include "controlspace/gradation/grade.h"

#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <numeric>
#include <vector>

#include "controlspace/error.h"
#include "controlspace/geometry/point.h"
#include "controlspace/metric/intersection.h"
#include "controlspace/metric/nonconformity.h"
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

// First in, first out; every node is in it at most once, so a ring with as many slots as nodes
// never overflows.
class NodeQueue {
public:
    // All of `nodes` nodes, in order.
    explicit NodeQueue(std::size_t nodes) : ring_(nodes), waits_(nodes, 1), size_(nodes) {
        std::iota(ring_.begin(), ring_.end(), NodeIndex{0});
    }
    bool empty() const { return size_ == 0; }
    NodeIndex pop() {
        const NodeIndex node = ring_[head_];
        head_ = next(head_);
        --size_;
        waits_[node] = 0;
        return node;
    }
    // Without effect on a node that waits already.
    void push(NodeIndex node) {
        if (waits_[node] != 0) return;
        waits_[node] = 1;
        ring_[tail_] = node;
        tail_ = next(tail_);
        ++size_;
    }

private:
    std::size_t next(std::size_t i) const { return i + 1 == ring_.size() ? 0 : i + 1; }

    std::vector<NodeIndex> ring_;
    std::vector<std::uint8_t> waits_;
    std::size_t head_ = 0, tail_ = 0, size_;
};

// The two schedules that go from node to node, on one thread: results depend on the order of turns,
// except for isotropic metrics under the cone law and the queue. The exact field
// (GradationSchedule::sources) has no order, and is evaluated on all threads.

// What is graded, and how. Neighbours must be mutual for all schedules but the passes.
template <class Graph>
struct Grading {
    const Graph& graph;
    OrderedMetrics metrics;  // of the nodes of `graph`; made smaller in place
    GradationLaw law;
    double ratio;  // g_r, >= 1

    // One node's turn: applies the law to the node and each of its neighbours, and calls
    // changed(node) for each metric made smaller.
    template <class Changed>
    void limit_around(NodeIndex i, Changed&& changed) const {
        graph.for_each_link(i, [&](NodeIndex j, const Vector& v) {
            const Limited limited = limit_growth(law, ratio, v, metrics[i], metrics[j]);
            if (limited.first) changed(i);
            if (limited.second) changed(j);
        });
    }
};

// The queue schedule (paper §3.2): applies the law to every node and its neighbours, and again to
// those that changed, until nothing changes. Returns the number of metrics made smaller.
//
// For isotropic metrics under the cone law the result does not depend on the order of turns, to
// the bit. A turn sets h_j to min(h_j, fl(h_i + (g-1)|v|)), which grows with both sizes and never
// exceeds h_j. Let H be the largest field at or below the initial one that no turn changes: by
// monotony no turn leads below H, and where turns end, nothing changes any more, so the field is H.
// They do end: every size is one of finitely many sums along paths. And |v| is the same from both
// ends.
template <class Graph>
std::uint64_t grade_by_queue(const Grading<Graph>& grading) {
    std::uint64_t operations = 0;
    NodeQueue queue(grading.graph.size());
    while (!queue.empty()) {
        grading.limit_around(queue.pop(), [&](NodeIndex changed) {
            ++operations;
            queue.push(changed);
        });
    }
    return operations;
}

// The pass schedule, which the paper's tables were made with though its text describes the queue:
// at most ten passes over the active nodes, in their order. In its turn a node is limited by all
// its neighbours, as they were, and then limits them, unless all are alike. After a pass, those
// nodes are active that are more than 5 % steeper than g_r towards any neighbour. Returns the
// number of metrics made smaller.
template <class Graph>
std::uint64_t grade_by_passes(const Grading<Graph>& grading) {
    constexpr int most_passes = 10;
    constexpr double alike = 0.01;  // non-conformity
    constexpr double slack = 1.05;
    struct Link {
        NodeIndex node;
        Vector v;
        Growth inwards;  // from the neighbour to the node whose turn it is
    };
    const Graph& graph = grading.graph;
    const OrderedMetrics metrics = grading.metrics;
    const auto growth = [&](const Metric& from, const Metric& to, const Vector& v) {
        return growth_between(grading.law, from, to, v);
    };
    std::uint64_t operations = 0;
    const auto limit = [&](Metric& m, const Growth& found, const Metric& by) {
        if (!found.exceeds(grading.ratio)) return;
        m = intersection(m, found.allowed(grading.ratio) * by);
        ++operations;
    };
    std::vector<Link> links;
    const auto limit_around = [&](NodeIndex i) {
        Metric& m = metrics[i];
        bool all_alike = true;
        links.clear();
        graph.for_each_link(i, [&](NodeIndex j, const Vector& v) {
            links.push_back({j, v, growth(metrics[j], m, v)});
            all_alike = all_alike && nonconformity(m, metrics[j]) < alike;
        });
        if (all_alike) return;
        for (const Link& link : links) limit(m, link.inwards, metrics[link.node]);
        for (const Link& link : links) {
            Metric& other = metrics[link.node];
            limit(other, growth(m, other, link.v), m);
        }
    };
    const auto is_too_steep = [&](NodeIndex i) {
        const Metric& m = metrics[i];
        bool steep = false;
        graph.for_each_link(i, [&](NodeIndex j, const Vector& v) {
            const Metric& other = metrics[j];
            steep = steep || growth(m, other, v).gradation() > slack * grading.ratio ||
                    growth(other, m, v).gradation() > slack * grading.ratio;
        });
        return steep;
    };

    std::vector<NodeIndex> active(graph.size());
    std::iota(active.begin(), active.end(), NodeIndex{0});
    for (int pass = 0; pass < most_passes; ++pass) {
        const std::uint64_t before = operations;
        for (const NodeIndex i : active) limit_around(i);
        if (operations == before) break;  // as all later passes would be
        active.clear();
        for (NodeIndex i = 0; i < graph.size(); ++i) {
            if (is_too_steep(i)) active.push_back(i);
        }
    }
    return operations;
}

template <class Graph>
std::uint64_t grade_nodes(const Graph& graph, OrderedMetrics metrics,
                          const GradationOptions& options) {
    const Grading<Graph> grading{graph, metrics, options.law, options.ratio};
    return options.schedule == GradationSchedule::passes ? grade_by_passes(grading)
                                                         : grade_by_queue(grading);
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
