#include "baselines/openvdb/level_nodes.h"

#include <openvdb/tree/LeafManager.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <cstdlib>
#include <optional>
#include <utility>

#include "controlspace/space/control_space_builder.h"
#include "controlspace/trees/detail/adjacency.h"
#include "controlspace/trees/detail/corners.h"

namespace controlspace {

namespace {

using Coord = openvdb::Coord;
using Pair = std::pair<NodeIndex, NodeIndex>;

NodeIndex node(std::int32_t number) { return static_cast<NodeIndex>(number); }

/// The cell beyond face `face` of cell c: 2 axis for the low face, 2 axis + 1 for the high one.
Coord across(const Coord& c, int face) {
    Coord neighbour = c;
    neighbour[face / 2] += face % 2 == 1 ? 1 : -1;
    return neighbour;
}

}  // namespace

LevelNodes::LevelNodes(const LevelCells& cells, std::span<const VdbLevelTree> trees,
                       Interpolation interpolation)
    : cells_(cells), trees_(trees), interpolation_(interpolation) {
    numbers_.reserve(trees.size());
    for (const VdbLevelTree& tree : trees) {
        numbers_.emplace_back(tree, none, openvdb::TopologyCopy());
        numbers_.back().voxelizeActiveTiles();
    }
    for (int level = 0; level < cells.levels(); ++level) number(level);
}

void LevelNodes::number(int level) {
    using Leaf = NumberTree::LeafNodeType;
    const VdbLevelTree& tree = trees_[static_cast<std::size_t>(level)];
    openvdb::tree::LeafManager<NumberTree> leaves(numbers_[static_cast<std::size_t>(level)]);
    std::vector<std::size_t> first(leaves.leafCount() + 1, 0);
    leaves.foreach ([&](Leaf& leaf, std::size_t i) {
        if (interpolation_ == Interpolation::trilinear) {
            const auto* held = tree.probeConstLeaf(leaf.origin());
            for (openvdb::Index k = 0; held != nullptr && k < Leaf::SIZE; ++k) {
                if (held->getValue(k) != no_metric) leaf.setValueOn(k, none);
            }
        }
        // A vertex that a finer level has too is one with it.
        const NumberReader finer(numbers_);
        for (auto voxel = leaf.beginValueOn(); voxel; ++voxel) {
            std::int32_t known = none;
            for (int l = level - 1; l >= 0 && interpolation_ == Interpolation::trilinear; --l) {
                known = finer[l].getValue(voxel.getCoord() << static_cast<std::size_t>(level - l));
                if (known != none) break;
            }
            voxel.setValue(known);
            first[i + 1] += known == none ? 1 : 0;
        }
    });
    first[0] = size_;
    for (std::size_t i = 1; i < first.size(); ++i) first[i] += first[i - 1];
    size_ = first.back();
    leaves.foreach ([&](Leaf& leaf, std::size_t i) {
        auto next = static_cast<std::int32_t>(first[i]);
        for (auto voxel = leaf.beginValueOn(); voxel; ++voxel) {
            if (*voxel == none) voxel.setValue(next++);
        }
    });
}

// visit(number, c, access) for the nodes of a level, those of finer levels among them; `access`
// are accessors to `trees` that serve one leaf.
template <class Trees, class Visit>
void LevelNodes::for_each_node(int level, const Trees& trees, Visit&& visit) const {
    const NumberTree& numbers = numbers_[static_cast<std::size_t>(level)];
    openvdb::tree::LeafManager<const NumberTree> leaves(numbers);
    leaves.foreach ([&](const NumberTree::LeafNodeType& leaf, std::size_t) {
        const LevelAccess<const std::remove_const_t<typename Trees::value_type>> access(trees);
        for (auto voxel = leaf.cbeginValueOn(); voxel; ++voxel) {
            visit(node(*voxel), voxel.getCoord(), access);
        }
    });
}

std::vector<Metric> LevelNodes::metrics() const {
    std::vector<Metric> metrics(size_);
    for (int level = 0; level < cells_.levels(); ++level) {
        for_each_node(level, trees_, [&](NodeIndex n, const Coord& c, const LevelReader& at) {
            metrics[n] = at.metric(level, c);
        });
    }
    return metrics;
}

std::vector<Point> LevelNodes::positions() const {
    std::vector<Point> positions(size_);
    for (int level = 0; level < cells_.levels(); ++level) {
        for_each_node(level, numbers_, [&](NodeIndex n, const Coord& c, const NumberReader&) {
            positions[n] = interpolation_ == Interpolation::nearest ? cells_.centre(level, c)
                                                                    : cells_.vertex(level, c);
        });
    }
    return positions;
}

void LevelNodes::assign(std::span<const Metric> metrics, std::span<VdbLevelTree> trees) const {
    require_one_each(metrics.size(), size_);
    for (std::size_t l = 0; l < trees.size(); ++l) {
        trees[l].voxelizeActiveTiles();
        openvdb::tree::LeafManager<VdbLevelTree> leaves(trees[l]);
        leaves.foreach ([&](VdbLevelTree::LeafNodeType& leaf, std::size_t) {
            const auto* numbers = numbers_[l].probeConstLeaf(leaf.origin());
            for (auto voxel = numbers->cbeginValueOn(); voxel; ++voxel) {
                leaf.setValueOnly(voxel.pos(), VdbMetric(metrics[node(*voxel)]));
            }
        });
    }
}

NodeGraph LevelNodes::graph(Neighbourhood neighbourhood) const {
    NodeGraph graph = interpolation_ == Interpolation::trilinear ? graph_of_vertices(neighbourhood)
                      : neighbourhood == Neighbourhood::nearest_per_face
                          ? graph_of_nearest()
                          : graph_of_cells(neighbourhood);
    graph.positions = positions();
    return graph;
}

// Pairs that links(pairs, numbers, level, c) appends for each active cell. Parts of the leaves are
// gathered apart and put together in order, so threads do not show.
template <class Links>
std::vector<Pair> LevelNodes::pairs(Links&& links) const {
    constexpr std::size_t leaves_per_part = 64;
    std::vector<Pair> all;
    for (int level = 0; level < cells_.levels(); ++level) {
        const auto l = static_cast<std::size_t>(level);
        const openvdb::tree::LeafManager<const NumberTree> leaves(numbers_[l]);
        std::vector<std::vector<Pair>> parts((leaves.leafCount() + leaves_per_part - 1) /
                                             leaves_per_part);
        tbb::parallel_for(std::size_t{0}, parts.size(), [&](std::size_t part) {
            const NumberReader numbers(numbers_);
            const LevelReader active(trees_);
            const std::size_t end = std::min(leaves.leafCount(), (part + 1) * leaves_per_part);
            for (std::size_t i = part * leaves_per_part; i < end; ++i) {
                for (auto voxel = leaves.leaf(i).cbeginValueOn(); voxel; ++voxel) {
                    const Coord c = voxel.getCoord();
                    if (active[level].isValueOn(c)) links(parts[part], numbers, active, level, c);
                }
            }
        });
        for (const auto& part : parts) all.insert(all.end(), part.begin(), part.end());
    }
    return all;
}

NodeGraph LevelNodes::graph_of_cells(Neighbourhood neighbourhood) const {
    const bool all = neighbourhood == Neighbourhood::all;
    std::vector<Coord> steps;
    steps.reserve(26);
    for (int face = 0; face < 6; ++face) steps.push_back(across({}, face));
    for (int i = 0; i < 27 && all; ++i) {
        const Coord step(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1);
        if (std::abs(step.x()) + std::abs(step.y()) + std::abs(step.z()) > 1) steps.push_back(step);
    }
    NodeGraph graph =
        graph_from_pairs(size_, pairs([&](std::vector<Pair>& found, const NumberReader& numbers,
                                          const LevelReader&, int level, const Coord& c) {
                             for (const Coord& step : steps)
                                 enter_pair(found, numbers, level, c, c + step);
                         }));
    if (all) sort_rows_uniquely(graph);  // a large cell is beyond several sides of a small one
    return graph;
}

// The node of the active cell that holds a finest cell, and its level.
std::pair<NodeIndex, int> LevelNodes::node_at(const NumberReader& numbers, const Coord& finest,
                                              int likely) {
    const int level = numbers.level_at(finest, likely);
    return {node(numbers[level].getValue(finest >> static_cast<std::size_t>(level))), level};
}

// The active cell c and the one at `neighbour`, unless that is finer: the finer of two enters the
// pair, and of two alike the one that is low.
void LevelNodes::enter_pair(std::vector<Pair>& pairs, const NumberReader& numbers, int level,
                            const Coord& c, const Coord& neighbour) const {
    if (!cells_.contains(level, neighbour)) return;
    const auto [other, its_level] =
        node_at(numbers, neighbour << static_cast<std::size_t>(level), level);
    if (its_level > level || (its_level == level && neighbour > c)) {
        pairs.emplace_back(node(numbers[level].getValue(c)), other);
    }
}

// The cell across a face, opposite to its middle; the low one where several meet there.
NodeIndex LevelNodes::nearest_across(const NumberReader& numbers, int level, const Coord& c,
                                     int face) const {
    const int parts = 1 << level;  // of the finest level, along an edge of c
    Coord finest;
    const Coord is_cut = cells_.step(7);
    for (int a = 0; a < 3; ++a) finest[a] = c[a] * parts + is_cut[a] * ((parts - 1) / 2);
    const int a = face / 2;
    finest[a] = face % 2 == 1 ? (c[a] + 1) * parts : c[a] * parts - 1;
    return node_at(numbers, finest, level).first;
}

NodeGraph LevelNodes::graph_of_nearest() const {
    constexpr NodeIndex nobody = ~NodeIndex{0};
    std::vector<std::array<NodeIndex, 6>> rows(size_);
    for (int level = 0; level < cells_.levels(); ++level) {
        for_each_node(level, numbers_,
                      [&](NodeIndex n, const Coord& c, const NumberReader& numbers) {
                          for (int face = 0; face < 6; ++face) {
                              const bool inside = cells_.contains(level, across(c, face));
                              rows[n][static_cast<std::size_t>(face)] =
                                  inside ? nearest_across(numbers, level, c, face) : nobody;
                          }
                      });
    }
    NodeGraph graph;
    graph.first.reserve(size_ + 1);
    graph.first.push_back(0);
    for (const auto& row : rows) {
        for (const NodeIndex neighbour : row) {
            if (neighbour != nobody) graph.neighbours.push_back(neighbour);
        }
        graph.first.push_back(graph.neighbours.size());
    }
    return graph;
}

NodeGraph LevelNodes::graph_of_vertices(Neighbourhood neighbourhood) const {
    NodeGraph graph = graph_from_pairs(
        size_, pairs([&](std::vector<Pair>& found, const NumberReader& numbers, const LevelReader&,
                         int level, const Coord& c) {
            Corners corners;
            for (std::size_t i = 0; i < 8; ++i) {
                corners[i] = node(numbers[level].getValue(c + cells_.step(i)));
            }
            for_each_pair(corners, neighbourhood,
                          [&](NodeIndex a, NodeIndex b) { found.emplace_back(a, b); });
        }));
    sort_rows_uniquely(graph);
    return graph;
}

}  // namespace controlspace
