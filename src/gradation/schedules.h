// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <numeric>
#include <span>
#include <vector>

#include "controlspace/gradation/law.h"
#include "controlspace/gradation/node_graph.h"
#include "controlspace/gradation/ordered_metrics.h"
#include "controlspace/metric/intersection.h"
#include "controlspace/metric/nonconformity.h"
#include "gradation/node_queue.h"

namespace controlspace {

// The schedules of gradation. All but the passes end where no pair of neighbours breaks the law.
//
// | function        | threads | for                         | result                    |
// |-----------------|---------|-----------------------------|---------------------------|
// | grade_by_queue  | one     | any metrics and law         | the paper's queue         |
// | grade_in_levels | all     | any metrics and law         | as the queue, to the bit  |
// | grade_in_rounds | all     | isotropic metrics, cone law | as the queue, to the bit  |
// | grade_by_passes | one     | any metrics and law         | as in the paper's tables  |

/// What is graded, and how. Neighbours must be mutual for all schedules but the passes.
template <class Graph>
struct Grading {
    const Graph& graph;
    OrderedMetrics metrics;  ///< of the nodes of `graph`; made smaller in place
    GradationLaw law;
    double ratio;  ///< g_r, >= 1

    /// One node's turn: applies the law to the node and each of its neighbours, and calls
    /// changed(node) for each metric made smaller.
    template <class Changed>
    void limit_around(NodeIndex i, Changed&& changed) const {
        graph.for_each_link(i, [&](NodeIndex j, const Vector& v) {
            const Limited limited = limit_growth(law, ratio, v, metrics[i], metrics[j]);
            if (limited.first) changed(i);
            if (limited.second) changed(j);
        });
    }
};

/// The queue schedule (paper §3.2): applies the law to every node and its neighbours, and again to
/// those that changed, until nothing changes. Returns the number of metrics made smaller.
template <class Graph>
std::uint64_t grade_by_queue(const Grading<Graph>& grading) {
    std::uint64_t operations = 0;
    NodeQueue queue(grading.graph.size());
    while (!queue.empty()) {
        const NodeIndex node = queue.take();
        queue.let_return(node);
        grading.limit_around(node, [&](NodeIndex changed) {
            ++operations;
            queue.push(changed);
        });
    }
    return operations;
}

/// As grade_by_queue, on all of TBB's threads and with the same result to the bit, whatever the
/// law. Faster where a turn is long: for metrics that are not isotropic.
///
/// A turn reads and writes the metrics of a node and of its neighbours only. So of the turns in the
/// queue, those that have no node in common may be exchanged. Each is given a level above those of
/// all earlier turns that it shares a node with; turns of one level have no node in common and run
/// at the same time, level by level. What they push enters the queue afterwards, in the order of
/// the turns.
template <class Graph>
std::uint64_t grade_in_levels(const Grading<Graph>& grading) {
    struct Turn {
        NodeIndex node = 0;
        std::vector<NodeIndex> changed;
    };
    constexpr std::size_t most_turns = 16384;  // enough that levels are wide
    constexpr std::size_t turns_per_task = 16;
    const Graph& graph = grading.graph;
    NodeQueue queue(graph.size());
    std::vector<Turn> turns(most_turns);
    std::vector<std::vector<Turn*>> levels;
    // Above the last turn that touches a node; levels of earlier batches lie below `base`.
    std::vector<std::uint64_t> next_level(graph.size(), 0);
    std::uint64_t base = 0;
    std::uint64_t operations = 0;
    while (!queue.empty()) {
        const std::span batch(turns.data(), std::min(queue.size(), most_turns));
        for (Turn& turn : batch) {
            turn.node = queue.take();
            std::uint64_t level = std::max(base, next_level[turn.node]);
            graph.for_each_neighbour(turn.node,
                                     [&](NodeIndex j) { level = std::max(level, next_level[j]); });
            if (level - base == levels.size()) levels.emplace_back();
            levels[level - base].push_back(&turn);
            next_level[turn.node] = level + 1;
            graph.for_each_neighbour(turn.node, [&](NodeIndex j) { next_level[j] = level + 1; });
        }
        base += levels.size();
        for (std::vector<Turn*>& level : levels) {
            const tbb::blocked_range<std::size_t> all(0, level.size(), turns_per_task);
            tbb::parallel_for(all, [&](const tbb::blocked_range<std::size_t>& range) {
                for (std::size_t t = range.begin(); t < range.end(); ++t) {
                    Turn& turn = *level[t];
                    grading.limit_around(turn.node,
                                         [&](NodeIndex node) { turn.changed.push_back(node); });
                }
            });
            level.clear();
        }
        for (Turn& turn : batch) {
            queue.let_return(turn.node);
            for (const NodeIndex node : turn.changed) queue.push(node);
            operations += turn.changed.size();
            turn.changed.clear();
        }
    }
    return operations;
}

/// The queue schedule for isotropic metrics under the cone law, on their sizes alone and on all of
/// TBB's threads: every node applies its cone to its neighbours, then all nodes that became
/// smaller do, round by round.
///
/// The result does not depend on the order of turns, to the bit. A turn sets h_j to
/// min(h_j, fl(h_i + (g-1)|v|)), which grows with both sizes and never exceeds h_j. Let H be the
/// largest field at or below the initial one that no turn changes: by monotony no turn leads below
/// H, and where turns end, nothing changes any more, so the field is H. They do end: every size is
/// one of finitely many sums along paths. And |v| is the same from both ends.
template <class Graph>
void grade_in_rounds(const Graph& graph, std::span<double> sizes, double ratio) {
    std::vector<std::uint8_t> waits(sizes.size(), 1);  // for its turn
    const auto limit_neighbours = [&](NodeIndex i, std::vector<NodeIndex>& lowered) {
        // Before the size is read: who makes it smaller from now on gives the node another turn.
        std::atomic_ref(waits[i]).store(0);
        const double h = std::atomic_ref(sizes[i]).load();
        graph.for_each_link(i, [&](NodeIndex j, const Vector& v) {
            const std::atomic_ref<double> other(sizes[j]);
            double size = other.load(std::memory_order_relaxed);
            if (size <= h) return;  // no cone is that small
            const double limit = cone_limit(h, ratio, v);
            while (size > limit) {
                if (!other.compare_exchange_weak(size, limit)) continue;
                if (std::atomic_ref(waits[j]).exchange(1) == 0) lowered.push_back(j);
                break;
            }
        });
    };

    constexpr std::size_t nodes_per_task = 512;
    std::vector<NodeIndex> turns(sizes.size());
    std::iota(turns.begin(), turns.end(), NodeIndex{0});
    tbb::enumerable_thread_specific<std::vector<NodeIndex>> lowered_by_thread;
    while (!turns.empty()) {
        const tbb::blocked_range<std::size_t> all(0, turns.size(), nodes_per_task);
        tbb::parallel_for(all, [&](const tbb::blocked_range<std::size_t>& range) {
            std::vector<NodeIndex>& lowered = lowered_by_thread.local();
            for (std::size_t t = range.begin(); t < range.end(); ++t) {
                limit_neighbours(turns[t], lowered);
            }
        });
        turns.clear();
        for (std::vector<NodeIndex>& lowered : lowered_by_thread) {
            turns.insert(turns.end(), lowered.begin(), lowered.end());
            lowered.clear();
        }
    }
}

/// The pass schedule, which the paper's tables were made with though its text describes the queue:
/// at most ten passes over the active nodes, in their order. In its turn a node is limited by all
/// its neighbours, as they were, and then limits them, unless all are alike. After a pass, those
/// nodes are active that are more than 5 % steeper than g_r towards any neighbour. Returns the
/// number of metrics made smaller.
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

}  // namespace controlspace
