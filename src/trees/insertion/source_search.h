// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <span>

#include "controlspace/sources/point_source.h"
#include "trees/topology/topology.h"

namespace controlspace {

/// Finds the leaves that hold sources, on all of TBB's threads: calls visit(first, positions,
/// leaves) for some sources at a time, numbered from `first` on, in no order.
template <class Node, class Visit>
void find_leaves(const Topology<Node>& tree, std::span<const PointSource> sources,
                 const Visit& visit) {
    constexpr std::size_t at_a_time = Topology<Node>::most_found;
    const auto find = [&](std::size_t first, std::size_t n) {
        std::array<Point, at_a_time> x;
        std::array<LeafIndex, at_a_time> leaves;
        for (std::size_t i = 0; i < n; ++i) x[i] = sources[first + i].position;
        tree.find({x.data(), n}, leaves);
        visit(first, std::span<const Point>(x).first(n),
              std::span<const LeafIndex>(leaves).first(n));
    };
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, sources.size(), 2 * at_a_time),
                      [&](const tbb::blocked_range<std::size_t>& range) {
                          for (std::size_t i = range.begin(); i < range.end(); i += at_a_time) {
                              find(i, std::min(at_a_time, range.end() - i));
                          }
                      });
}

}  // namespace controlspace
