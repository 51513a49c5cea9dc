// SPDX-License-Identifier: Apache-2.0
#include "trees/topology/adjacency.h"

#include <tbb/parallel_for.h>

#include <algorithm>

#include "geometry/threads.h"

namespace controlspace {

void link_pairs(NodeGraph& graph, std::size_t nodes,
                std::span<const std::pair<NodeIndex, NodeIndex>> pairs) {
    link(graph, nodes, [&](const auto& enter) {
        for (const auto& [a, b] : pairs) {
            enter(a, b);
            enter(b, a);
        }
    });
}

NodeGraph vertex_graph(std::span<const Corners> leaves, std::vector<Point> positions,
                       Neighbourhood neighbourhood) {
    // Each thread enters the neighbours of nodes of its own; rows get sorted in the end.
    const std::size_t nodes = positions.size();
    const std::size_t shares = threads_allowed();
    const auto border = [&](std::size_t share) {
        return static_cast<NodeIndex>(share * nodes / shares);
    };
    NodeGraph graph;
    link(graph, nodes, [&](const auto& enter) {
        tbb::parallel_for(std::size_t{0}, shares, [&](std::size_t share) {
            const NodeIndex low = border(share);
            const NodeIndex high = border(share + 1);
            const auto enter_own = [&](NodeIndex node, NodeIndex neighbour) {
                if (low <= node && node < high) enter(node, neighbour);
            };
            for (const Corners& corners : leaves) {
                for_each_pair(corners, neighbourhood, [&](NodeIndex a, NodeIndex b) {
                    enter_own(a, b);
                    enter_own(b, a);
                });
            }
        });
    });
    sort_rows_uniquely(graph);
    graph.positions = std::move(positions);
    return graph;
}

void sort_rows_uniquely(NodeGraph& graph) {
    // Each row for itself; then rows are moved together.
    const std::size_t rows = graph.first.size() - 1;
    const auto at = [&](std::size_t i) {
        return graph.neighbours.begin() + static_cast<std::ptrdiff_t>(i);
    };
    std::vector<NodeIndex> sizes(rows);
    tbb::parallel_for(std::size_t{0}, rows, [&](std::size_t row) {
        const auto begin = at(graph.first[row]);
        const auto end = at(graph.first[row + 1]);
        std::sort(begin, end);
        sizes[row] = static_cast<NodeIndex>(std::unique(begin, end) - begin);
    });
    std::size_t used = 0;
    for (std::size_t row = 0; row < rows; ++row) {
        const auto begin = at(std::exchange(graph.first[row], used));
        std::move(begin, begin + static_cast<std::ptrdiff_t>(sizes[row]), at(used));
        used += sizes[row];
    }
    graph.first.back() = used;
    graph.neighbours.resize(used);
}

}  // namespace controlspace
