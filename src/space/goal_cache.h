// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tbb/concurrent_queue.h>
#include <tbb/concurrent_unordered_map.h>

#include <array>
#include <cstddef>
#include <utility>

#include "cones/order_free_cones.h"
#include "controlspace/geometry/point.h"
#include "controlspace/metric/metric.h"
#include "geometry/hash_of_words.h"

namespace controlspace {

/// What the adaptation to a field keeps from leaf to leaf: answers at places that leaves share, up
/// to some number of them, and the memory of searches. None of it has an effect on answers.
/// Thread-safe, but for `forget_if_full`.
class GoalCache {
public:
    explicit GoalCache(std::size_t most_answers) : most_answers_(most_answers) {}

    struct Answer {
        Metric metric;
        OrderFreeCones::Start start;  ///< for places nearby, if it has members
    };

    bool recall(const Point& x, Answer& out) const {
        const auto found = answers_.find({x.x(), x.y(), x.z()});
        if (found == answers_.end()) return false;
        out = found->second;
        return true;
    }
    bool has(const Point& x) const { return answers_.contains({x.x(), x.y(), x.z()}); }
    bool has_room_for(std::size_t more) const { return answers_.size() + more < most_answers_; }
    void remember(const Point& x, const Answer& answer) {
        if (is_full()) return;
        answers_.emplace(std::array{x.x(), x.y(), x.z()}, answer);
    }
    void forget_if_full() {
        if (is_full()) answers_.clear();
    }

    /// The memory of an earlier search of the field, if there is one.
    OrderFreeCones::Search borrow() {
        OrderFreeCones::Search search;
        searches_.try_pop(search);
        return search;
    }
    /// Where memory runs out, it is not kept.
    void give_back(OrderFreeCones::Search&& search) noexcept {
        try {
            searches_.push(std::move(search));
        } catch (...) {
        }
    }

private:
    bool is_full() const { return answers_.size() >= most_answers_; }

    struct Hash {
        std::size_t operator()(const std::array<double, 3>& x) const { return hash_of_words(x); }
    };
    std::size_t most_answers_;
    tbb::concurrent_unordered_map<std::array<double, 3>, Answer, Hash> answers_;
    tbb::concurrent_queue<OrderFreeCones::Search> searches_;
};

}  // namespace controlspace
