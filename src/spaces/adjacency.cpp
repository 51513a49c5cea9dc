#include "spaces/adjacency.h"

namespace controlspace {

NodeGraph graph_from_pairs(std::size_t nodes,
                           std::span<const std::pair<NodeIndex, NodeIndex>> pairs) {
    NodeGraph graph;
    graph.first.assign(nodes + 1, 0);
    for (const auto& [a, b] : pairs) {
        ++graph.first[a + 1];
        ++graph.first[b + 1];
    }
    for (std::size_t i = 0; i < nodes; ++i) graph.first[i + 1] += graph.first[i];
    graph.neighbours.resize(2 * pairs.size());
    std::vector<std::size_t> next(graph.first.begin(), graph.first.end() - 1);
    for (const auto& [a, b] : pairs) {
        graph.neighbours[next[a]++] = b;
        graph.neighbours[next[b]++] = a;
    }
    return graph;
}

NodeGraph vertex_graph(std::span<const Corners> leaves, std::vector<Point> positions,
                       Neighbourhood neighbourhood) {
    std::vector<std::pair<NodeIndex, NodeIndex>> pairs;
    pairs.reserve((neighbourhood == Neighbourhood::all ? 28 : 12) * leaves.size());
    for (const Corners& corners : leaves) {
        for_each_pair(corners, neighbourhood,
                      [&](NodeIndex a, NodeIndex b) { pairs.emplace_back(a, b); });
    }
    NodeGraph graph = graph_from_pairs(positions.size(), pairs);
    sort_rows_uniquely(graph);
    graph.positions = std::move(positions);
    return graph;
}

void sort_rows_uniquely(NodeGraph& graph) {
    const auto begin = graph.neighbours.begin();
    auto end = begin;
    std::size_t row = 0;
    for (std::size_t i = 0; i + 1 < graph.first.size(); ++i) {
        const auto from = begin + static_cast<std::ptrdiff_t>(row);
        const auto to = begin + static_cast<std::ptrdiff_t>(graph.first[i + 1]);
        row = graph.first[i + 1];
        std::sort(from, to);
        graph.first[i] = static_cast<std::size_t>(end - begin);
        for (auto it = from; it != to; ++it) {
            if (it == from || *it != *(it - 1)) *end++ = *it;
        }
    }
    graph.first.back() = static_cast<std::size_t>(end - begin);
    graph.neighbours.erase(end, graph.neighbours.end());
}

}  // namespace controlspace
