#pragma once

#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <atomic>
#include <cstdint>
#include <numeric>
#include <span>
#include <utility>
#include <vector>

#include "controlspace/gradation/law.h"
#include "controlspace/gradation/node_graph.h"

namespace controlspace {

/// The queue schedule for isotropic metrics under the cone law, by their sizes alone and on all of
/// TBB's threads: every node hands its cone on to its neighbours, then do those that it has made
/// smaller, round by round.
///
/// The result is the same to the bit in whatever order nodes take their turns, that of one queue
/// included. A turn sets h_j to min(h_j, fl(h_i + (g-1)|v|)), which grows with both sizes and never
/// exceeds h_j. Let H be the largest field at or below the first one that no turn changes: by
/// monotony no turn leads below H, and where turns end, nothing changes any more, so it is H. They
/// do end: every size is one of finitely many sums along paths. And |v| is the same from both ends.
template <class Graph>
class SizeRounds {
public:
    SizeRounds(const Graph& graph, std::span<double> sizes, double g)
        : graph_(graph), sizes_(sizes), g_(g), waits_(sizes.size(), 1) {}

    void run() {
        std::vector<NodeIndex> turns(sizes_.size());
        std::iota(turns.begin(), turns.end(), NodeIndex{0});
        while (!turns.empty()) {
            constexpr std::size_t nodes_per_task = 512;
            tbb::parallel_for(tbb::blocked_range<std::size_t>(0, turns.size(), nodes_per_task),
                              [&](const tbb::blocked_range<std::size_t>& range) {
                                  std::vector<NodeIndex>& lowered = lowered_.local();
                                  for (std::size_t k = range.begin(); k < range.end(); ++k) {
                                      hand_on(turns[k], lowered);
                                  }
                              });
            turns.clear();
            for (std::vector<NodeIndex>& lowered : lowered_) {
                turns.insert(turns.end(), lowered.begin(), lowered.end());
                lowered.clear();
            }
        }
    }

private:
    void hand_on(NodeIndex i, std::vector<NodeIndex>& lowered) {
        // Before the size is read: who makes it smaller from now on gives the node another turn.
        std::atomic_ref(waits_[i]).store(0);
        const double h = std::atomic_ref(sizes_[i]).load();
        graph_.for_each_link(i, [&](NodeIndex j, const Vector& v) {
            const std::atomic_ref<double> other(sizes_[j]);
            double size = other.load(std::memory_order_relaxed);
            if (size <= h) return;  // no cone is that small
            const double limit = cone_limit(h, g_, v);
            while (size > limit) {
                if (!other.compare_exchange_weak(size, limit)) continue;
                const std::atomic_ref<std::uint8_t> waits(waits_[j]);
                if (waits.exchange(1) == 0) lowered.push_back(j);
                break;
            }
        });
    }

    const Graph& graph_;
    std::span<double> sizes_;
    double g_;
    std::vector<std::uint8_t> waits_;  // for its turn
    tbb::enumerable_thread_specific<std::vector<NodeIndex>> lowered_;
};

}  // namespace controlspace
