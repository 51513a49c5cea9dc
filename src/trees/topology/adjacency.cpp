#include "controlspace/trees/detail/adjacency.h"

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

NodeGraph graph_from_pairs(std::size_t nodes,
                           std::span<const std::pair<NodeIndex, NodeIndex>> pairs) {
    NodeGraph graph;
    link_pairs(graph, nodes, pairs);
    return graph;
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

namespace {

// Sorts rows from `begin` to `end` and closes up what is left of them, from the first one's place
// on. Returns where they end. `last` is where the last row ended; the row after is not read.
std::size_t close_up(NodeGraph& graph, std::size_t begin, std::size_t end, std::size_t last) {
    const auto at = [&](std::size_t i) {
        return graph.neighbours.begin() + static_cast<std::ptrdiff_t>(i);
    };
    std::size_t from = graph.first[begin];
    auto next = at(from);
    for (std::size_t row = begin; row < end; ++row) {
        const std::size_t to = row + 1 < end ? graph.first[row + 1] : last;
        std::sort(at(from), at(to));
        graph.first[row] = static_cast<std::size_t>(next - graph.neighbours.begin());
        for (auto it = at(from); it != at(to); ++it) {
            if (it == at(from) || *it != *(it - 1)) *next++ = *it;
        }
        from = to;
    }
    return static_cast<std::size_t>(next - graph.neighbours.begin());
}

}  // namespace

void sort_rows_uniquely(NodeGraph& graph) {
    // Rows in blocks, each closed up for itself; then the blocks are moved together.
    constexpr std::size_t rows_per_block = 4096;
    const std::size_t rows = graph.first.size() - 1;
    const std::size_t blocks = (rows + rows_per_block - 1) / rows_per_block;
    std::vector<std::size_t> begins, ends;
    for (std::size_t b = 0; b < blocks; ++b) {
        begins.push_back(graph.first[b * rows_per_block]);
        ends.push_back(graph.first[std::min((b + 1) * rows_per_block, rows)]);
    }
    tbb::parallel_for(std::size_t{0}, blocks, [&](std::size_t b) {
        const std::size_t begin = b * rows_per_block;
        ends[b] = close_up(graph, begin, std::min(begin + rows_per_block, rows), ends[b]);
    });
    std::size_t used = 0;
    const auto from = graph.neighbours.begin();
    for (std::size_t b = 0; b < blocks; ++b) {
        std::move(from + static_cast<std::ptrdiff_t>(begins[b]),
                  from + static_cast<std::ptrdiff_t>(ends[b]),
                  from + static_cast<std::ptrdiff_t>(used));
        const std::size_t end = std::min((b + 1) * rows_per_block, rows);
        for (std::size_t row = b * rows_per_block; row < end; ++row) {
            graph.first[row] -= begins[b] - used;
        }
        used += ends[b] - begins[b];
    }
    graph.first.back() = used;
    graph.neighbours.resize(used);
}

}  // namespace controlspace
