#pragma once

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <vector>

#include "gradation/queue.h"

namespace controlspace {

/// What grade_by_queue does, on all of TBB's threads and with the same result to the bit, whatever
/// the law. Pays where a turn is long: for metrics that are not isotropic.
///
/// A turn reads and writes the metrics of a node and its neighbours, and nothing else. So of the
/// turns that the queue holds, those that have no node in common may change places. Each is given a
/// level above those of all earlier turns that it shares a node with; turns of one level have none
/// in common and run at the same time, level by level. What they push enters the queue afterwards,
/// in the order of the turns.
template <class Graph>
class ParallelQueue {
public:
    ParallelQueue(const Graph& graph, OrderedMetrics metrics, GradationLaw law, double g)
        : graph_(graph),
          metrics_(metrics),
          law_(law),
          g_(g),
          queue_(graph.size()),
          level_of_(graph.size(), 0),
          turns_(most_turns) {}

    /// Returns the number of metrics made smaller.
    std::uint64_t run() {
        while (!queue_.empty()) {
            count_ = std::min(queue_.size(), most_turns);
            for (std::size_t t = 0; t < count_; ++t) turns_[t].node = queue_.take();
            find_levels();
            for (std::size_t l = 0; l + 1 < first_.size(); ++l) run_level(first_[l], first_[l + 1]);
            for (std::size_t t = 0; t < count_; ++t) push_changed(turns_[t]);
        }
        return operations_;
    }

private:
    struct Turn {
        NodeIndex node = 0;
        std::uint32_t level = 0;  // from 0
        std::vector<NodeIndex> changed;
    };
    static constexpr std::size_t most_turns = 16384;  // enough that levels are wide

    // Levels of earlier turns lie at or below `base_`.
    void find_levels() {
        std::uint64_t top = base_;
        for (std::size_t t = 0; t < count_; ++t) {
            const NodeIndex i = turns_[t].node;
            std::uint64_t level = std::max(base_, level_of_[i]);
            graph_.for_each_neighbour(i,
                                      [&](NodeIndex j) { level = std::max(level, level_of_[j]); });
            turns_[t].level = static_cast<std::uint32_t>(level - base_);
            ++level;
            level_of_[i] = level;
            graph_.for_each_neighbour(i, [&](NodeIndex j) { level_of_[j] = level; });
            top = std::max(top, level);
        }
        // Turns in the order of their levels.
        first_.assign(top - base_ + 2, 0);
        for (std::size_t t = 0; t < count_; ++t) ++first_[turns_[t].level + std::size_t{2}];
        std::partial_sum(first_.begin(), first_.end(), first_.begin());
        by_level_.resize(count_);
        for (std::size_t t = 0; t < count_; ++t) {
            by_level_[first_[turns_[t].level + std::size_t{1}]++] = &turns_[t];
        }
        first_.pop_back();
        base_ = top;
    }

    void run_level(std::size_t begin, std::size_t end) {
        constexpr std::size_t turns_per_task = 16;
        tbb::parallel_for(tbb::blocked_range<std::size_t>(begin, end, turns_per_task),
                          [&](const tbb::blocked_range<std::size_t>& range) {
                              for (std::size_t k = range.begin(); k < range.end(); ++k) {
                                  Turn& turn = *by_level_[k];
                                  take_turn(graph_, metrics_, law_, g_, turn.node,
                                            [&](NodeIndex node) { turn.changed.push_back(node); });
                              }
                          });
    }

    void push_changed(Turn& turn) {
        queue_.let_return(turn.node);
        for (const NodeIndex node : turn.changed) queue_.push(node);
        operations_ += turn.changed.size();
        turn.changed.clear();
    }

    const Graph& graph_;
    OrderedMetrics metrics_;
    GradationLaw law_;
    double g_;
    NodeQueue queue_;
    std::vector<std::uint64_t> level_of_;  // of the last turn that had to do with a node
    std::vector<Turn> turns_;              // `count_` of them in the queue's order
    std::vector<Turn*> by_level_;
    std::vector<std::size_t> first_;  // of each level, in by_level_
    std::size_t count_ = 0;
    std::uint64_t base_ = 0;
    std::uint64_t operations_ = 0;
};

}  // namespace controlspace
