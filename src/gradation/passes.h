#pragma once

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <span>
#include <vector>

#include "gradation/law.h"
#include "gradation/node_graph.h"
#include "metric/intersection.h"
#include "metric/nonconformity.h"

namespace controlspace {

/// The pass schedule, which the paper's tables were made with though its text describes the queue:
/// at most ten passes over the active nodes, in their order. A node is first limited by all its
/// neighbours, as they were, and then limits them; it stays active while the steepest of the pairs
/// is more than 5 % above g. Nodes whose neighbours are all alike are left alone.
/// Returns the number of metrics made smaller.
template <class Graph>
std::uint64_t grade_by_passes(const Graph& graph, std::span<Metric> metrics, GradationLaw law,
                              double g) {
    constexpr int max_passes = 10;
    constexpr double alike = 0.01;  // non-conformity
    constexpr double slack = 1.05;

    struct Link {
        NodeIndex node;
        Vector v;
        Growth growth;  // from the neighbour to the node
    };
    std::vector<Link> links;
    std::uint64_t operations = 0;
    std::vector<NodeIndex> active(graph.size());
    std::iota(active.begin(), active.end(), NodeIndex{0});

    for (int pass = 0; pass < max_passes && !active.empty(); ++pass) {
        std::vector<NodeIndex> still_active;
        for (const NodeIndex i : active) {
            Metric& m0 = metrics[i];
            links.clear();
            bool all_alike = true;
            const Point p = graph.position(i);
            graph.for_each_neighbour(i, [&](NodeIndex j) {
                const Vector v = graph.position(j) - p;
                links.push_back({j, v, growth_between(law, metrics[j], m0, v)});
                all_alike = all_alike && nonconformity(m0, metrics[j]) < alike;
            });
            if (all_alike) continue;

            for (const Link& link : links) {
                if (!link.growth.exceeds(g)) continue;
                m0 = intersection(m0, link.growth.allowed(g) * metrics[link.node]);
                ++operations;
            }
            double steepest = 1;
            for (const Link& link : links) {
                Metric& m1 = metrics[link.node];
                const Growth outwards = growth_between(law, m0, m1, link.v);
                if (outwards.exceeds(g)) {
                    m1 = intersection(m1, outwards.allowed(g) * m0);
                    ++operations;
                }
                steepest = std::max({steepest, growth_between(law, m0, m1, link.v).gradation(),
                                     growth_between(law, m1, m0, link.v).gradation()});
            }
            if (steepest > slack * g) still_active.push_back(i);
        }
        active = std::move(still_active);
    }
    return operations;
}

}  // namespace controlspace
