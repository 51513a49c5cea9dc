#pragma once

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <vector>

#include "controlspace/gradation/law.h"
#include "controlspace/gradation/node_graph.h"
#include "controlspace/gradation/ordered_metrics.h"
#include "controlspace/metric/intersection.h"
#include "controlspace/metric/nonconformity.h"

namespace controlspace {

/// The pass schedule, which the paper's tables were made with though its text describes the queue:
/// at most ten passes over the active nodes, in their order. In its turn a node is limited by all
/// its neighbours, as they were, and then limits them, unless all are alike. After a pass, those
/// nodes are active that are more than 5 % steeper than g towards any neighbour.
template <class Graph>
class PassSchedule {
public:
    PassSchedule(const Graph& graph, OrderedMetrics metrics, GradationLaw law, double g)
        : graph_(graph), metrics_(metrics), law_(law), g_(g) {}

    /// Returns the number of metrics made smaller.
    std::uint64_t run() {
        constexpr int max_passes = 10;
        std::vector<NodeIndex> active(graph_.size());
        std::iota(active.begin(), active.end(), NodeIndex{0});
        std::uint64_t operations = 0;
        for (int pass = 0; pass < max_passes; ++pass) {
            const std::uint64_t before = operations;
            for (const NodeIndex i : active) operations += limit_around(i);
            if (operations == before) break;  // as all later passes would be
            active.clear();
            for (NodeIndex i = 0; i < graph_.size(); ++i) {
                if (is_too_steep(i)) active.push_back(i);
            }
        }
        return operations;
    }

private:
    struct Link {
        NodeIndex node;
        Vector v;
        Growth inwards;  // from the neighbour to the node whose turn it is
    };

    std::uint64_t limit_around(NodeIndex i) {
        constexpr double alike = 0.01;  // non-conformity
        Metric& m0 = metrics_[i];
        bool all_alike = true;
        links_.clear();
        graph_.for_each_link(i, [&](NodeIndex j, const Vector& v) {
            links_.push_back({j, v, growth_between(law_, metrics_[j], m0, v)});
            all_alike = all_alike && nonconformity(m0, metrics_[j]) < alike;
        });
        if (all_alike) return 0;

        std::uint64_t operations = 0;
        const auto limit = [&](Metric& m, const Growth& growth, const Metric& by) {
            if (!growth.exceeds(g_)) return;
            m = intersection(m, growth.allowed(g_) * by);
            ++operations;
        };
        for (const Link& link : links_) limit(m0, link.inwards, metrics_[link.node]);
        for (const Link& link : links_) {
            Metric& m1 = metrics_[link.node];
            limit(m1, growth_between(law_, m0, m1, link.v), m0);
        }
        return operations;
    }

    bool is_too_steep(NodeIndex i) const {
        constexpr double slack = 1.05;
        const Metric& m0 = metrics_[i];
        bool steep = false;
        graph_.for_each_link(i, [&](NodeIndex j, const Vector& v) {
            const Metric& m1 = metrics_[j];
            steep = steep || growth_between(law_, m0, m1, v).gradation() > slack * g_ ||
                    growth_between(law_, m1, m0, v).gradation() > slack * g_;
        });
        return steep;
    }

    const Graph& graph_;
    OrderedMetrics metrics_;
    GradationLaw law_;
    double g_;
    std::vector<Link> links_;
};

}  // namespace controlspace
