// SPDX-License-Identifier: Apache-2.0
#include "trees/topology/place_index.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cmath>

#include "geometry/hash_of_words.h"
#include "trees/make_room.h"

namespace controlspace {

namespace {

constexpr NodeIndex none = ~NodeIndex{0};
constexpr std::size_t smallest_table = 64;

std::uint64_t hash(const Point& x) {
    return hash_of_words(Vector(Vector::Zero() + x));  // turns -0 into 0: the same place
}

}  // namespace

std::size_t PlaceIndex::slot_of(const Point& x, std::span<const Point> positions) const {
    const std::size_t mask = table_.size() - 1;
    std::size_t slot = hash(x) & mask;
    while (table_[slot] != none && positions[table_[slot]] != x) slot = (slot + 1) & mask;
    return slot;
}

void PlaceIndex::prefetch(const Point& x) const {
    if (!table_.empty()) __builtin_prefetch(&table_[hash(x) & (table_.size() - 1)]);
}

NodeIndex PlaceIndex::likely_at(const Point& x) const {
    return table_.empty() ? none : table_[hash(x) & (table_.size() - 1)];
}

PlaceIndex::PlaceIndex(std::span<const Point> positions) : used_(positions.size()) {
    enter_all(std::max(smallest_table, std::bit_ceil(2 * positions.size())), positions);
}

NodeIndex PlaceIndex::find_or_enter(const Point& x, NodeIndex next,
                                    std::span<const Point> positions) {
    if (2 * used_ >= table_.size()) grow(positions);
    NodeIndex& entry = table_[slot_of(x, positions)];
    if (entry == none) {
        entry = next;
        ++used_;
    }
    return entry;
}

void PlaceIndex::grow(std::span<const Point> positions) {
    enter_all(std::max(smallest_table, 2 * table_.size()), positions);
}

void PlaceIndex::enter_all(std::size_t slots, std::span<const Point> positions) {
    table_ = {};  // so that both are never there together
    table_ = large_array<NodeIndex>(slots, none);
    for (NodeIndex i = 0; i < positions.size(); ++i) table_[slot_of(positions[i], positions)] = i;
}

std::vector<NodeIndex> number_places(std::span<const Point> x, std::vector<Point>& distinct) {
    // All are entered at the same time; of equal ones the first stays. What it then finds again is
    // the same whatever came when.
    std::vector<NodeIndex> table =
        large_array<NodeIndex>(std::max(smallest_table, std::bit_ceil(x.size())), none);
    std::vector<NodeIndex> number = large_array<NodeIndex>(x.size());
    const auto for_each_slot = [&](const auto& visit) {
        tbb::parallel_for(tbb::blocked_range<std::size_t>(0, x.size(), 1024),
                          [&](const tbb::blocked_range<std::size_t>& range) {
                              constexpr std::size_t most = 32;  // whose slots are prefetched
                              std::array<std::size_t, most> slots;
                              for (std::size_t i = range.begin(); i < range.end(); i += most) {
                                  const std::size_t n = std::min(most, range.end() - i);
                                  for (std::size_t k = 0; k < n; ++k) {
                                      slots[k] = hash(x[i + k]) & (table.size() - 1);
                                      __builtin_prefetch(&table[slots[k]]);
                                  }
                                  for (std::size_t k = 0; k < n; ++k) {
                                      if (!std::isnan(x[i + k].x())) {
                                          visit(static_cast<NodeIndex>(i + k), slots[k]);
                                      }
                                  }
                              }
                          });
    };
    const auto next_slot = [&](std::size_t slot) { return (slot + 1) & (table.size() - 1); };
    for_each_slot([&](NodeIndex i, std::size_t slot) {
        for (;; slot = next_slot(slot)) {
            const std::atomic_ref<NodeIndex> entry(table[slot]);
            NodeIndex there = none;
            if (entry.compare_exchange_strong(there, i, std::memory_order_relaxed)) return;
            if (x[there] != x[i]) continue;
            while (i < there && !entry.compare_exchange_weak(there, i, std::memory_order_relaxed)) {
            }
            return;
        }
    });
    for_each_slot([&](NodeIndex i, std::size_t slot) {
        while (x[table[slot]] != x[i]) slot = next_slot(slot);
        number[i] = table[slot];
    });
    for (NodeIndex i = 0; i < x.size(); ++i) {
        if (std::isnan(x[i].x())) continue;
        if (number[i] != i) {
            number[i] = number[number[i]];
        } else {
            number[i] = static_cast<NodeIndex>(distinct.size());
            make_room(distinct, 1);
            distinct.push_back(x[i]);
        }
    }
    return number;
}

}  // namespace controlspace
