#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "baselines/openvdb/level_cells.h"
#include "baselines/openvdb/level_values.h"
#include "controlspace/metric/blend.h"
#include "controlspace/space/detail/state.h"

namespace controlspace {

/// The grids of a stack, the finest first, and their active voxels.
struct LevelStack {
    std::vector<VdbLevelTree> trees;
    std::size_t voxels = 0;

    /// One metric everywhere, in the coarsest grid.
    template <class Values>
    LevelStack(const LevelCells& cells, const Metric& metric, Values)
        : trees(static_cast<std::size_t>(cells.levels()), VdbLevelTree(no_metric)) {
        LevelWriter at(trees);
        Values::fill(at, cells, metric);
        voxels = trees.back().activeVoxelCount();
    }

    std::size_t bytes() const {
        std::size_t bytes = 0;
        for (const VdbLevelTree& tree : trees) bytes += tree.memUsage();
        return bytes;
    }
};

/// Metrics at `x`, for some points at a time (see Stencil::sample).
template <class Values>
void sample_levels(const LevelCells& cells, const LevelReader& at, std::span<const Point> x,
                   std::span<Metric> out) {
    CellBatch batch;
    std::array<int, CellBatch::most> levels;
    std::array<std::array<const VdbMetric*, Values::corners>, CellBatch::most> values;
    const auto cell = [&](std::size_t i) {
        const auto [a, b, c] = batch[i];
        return openvdb::Coord(a, b, c) >> static_cast<std::size_t>(levels[i]);
    };
    int level = cells.top();
    for (std::size_t first = 0; first < x.size(); first += CellBatch::most) {
        const std::size_t count = std::min(CellBatch::most, x.size() - first);
        cells.locate(x.subspan(first, count), batch);
        for (std::size_t i = 0; i < count; ++i) {
            levels[i] = 0;
            levels[i] = level = at.level_at(cell(i), level);
            const auto low = cell(i);
            values[i] = find_values<Values::corners, VdbLevelTree>(at[level], low,
                                                                   at[level].probeConstLeaf(low));
        }
        for (std::size_t i = 0; i < count; ++i) {
            if constexpr (Values::corners == 1) {
                out[first + i] = values[i][0]->metric;
            } else {
                const double cells_per_finest = 1.0 / (1 << levels[i]);
                const auto low = cell(i);
                const auto high = [&](std::size_t a) {
                    return batch.t[a][i] * cells_per_finest - low[static_cast<int>(a)];
                };
                out[first + i] = blend_lengths(
                    trilinear_weights({high(0), high(1), high(2)}),
                    [&](std::size_t corner) -> auto& { return values[i][corner]->metric; });
            }
        }
    }
}

/// Calls visit(metric) for the voxels of all grids that hold one, in a fixed order; `trees` may be
/// const, and have no tiles that hold any.
template <class Trees, class Visit>
void for_each_held(Trees& trees, Visit&& visit) {
    for (auto& tree : trees) {
        for (auto leaf = tree.beginLeaf(); leaf; ++leaf) {
            for (openvdb::Index i = 0; i < VdbLevelTree::LeafNodeType::SIZE; ++i) {
                if (leaf->getValue(i) != no_metric) visit(*leaf, i);
            }
        }
    }
}

/// Calls visit(level, c) for the cells of all levels that hold the active ones or are active,
/// depth first, down from each for which it returns true.
template <class Visit>
void descend(const LevelCells& cells, int level, const openvdb::Coord& c, Visit& visit) {
    if (!visit(level, c)) return;
    for (std::size_t i = 0; i < 8; ++i) {
        if (cells.has_part(i)) descend(cells, level - 1, (c << 1) + cells.step(i), visit);
    }
}
template <class Visit>
void descend(const LevelCells& cells, Visit&& visit) {
    const openvdb::Coord n = cells.cells_of(cells.top());
    for (openvdb::CoordBBox::Iterator<true> c({{}, n.offsetBy(-1)}); c; ++c) {
        descend(cells, cells.top(), *c, visit);
    }
}

/// Writes which cells are split, and the metrics of all voxels, under names that begin with `name`.
inline void save_levels(const LevelStack& stack, const LevelCells& cells, const std::string& name,
                        StateWriter& state) {
    std::vector<std::uint8_t> is_split;
    const LevelReader at(stack.trees);
    descend(cells, [&](int level, const openvdb::Coord& c) {
        is_split.push_back(at[level].isValueOn(c) ? 0 : 1);
        return is_split.back() != 0;
    });
    std::vector<Metric> metrics;
    std::vector<VdbLevelTree> trees = stack.trees;
    for (VdbLevelTree& tree : trees) tree.voxelizeActiveTiles();
    for_each_held(
        trees, [&](auto& leaf, openvdb::Index i) { metrics.push_back(leaf.getValue(i).metric); });
    state(name + ".is_split", is_split);
    state(name + ".metrics", metrics);
}

/// Puts what was saved into a new stack; split(at, level, c) splits a cell of it. Throws InputError
/// where the cells do not end or hold another number of metrics.
template <class Split>
void load_levels(LevelStack& stack, const LevelCells& cells, const std::string& name,
                 const StateReader& state, Split&& split) {
    std::vector<std::uint8_t> is_split;
    std::vector<Metric> metrics;
    state(name + ".is_split", is_split);
    state(name + ".metrics", metrics);
    require_metrics(state, name + ".metrics", metrics);
    LevelWriter at(stack.trees);
    std::size_t next = 0;
    descend(cells, [&](int level, const openvdb::Coord& c) {
        state.require(next < is_split.size(), name + ".is_split", "ends too early");
        const bool splits = is_split[next++] != 0;
        state.require(!splits || level > 0, name + ".is_split", "splits a finest cell");
        if (splits) split(at, level, c);
        return splits;
    });
    std::size_t used = 0;
    for_each_held(stack.trees, [&](auto& leaf, openvdb::Index i) {
        if (used < metrics.size()) leaf.setValueOnly(i, VdbMetric(metrics[used]));
        ++used;
    });
    state.require(next == is_split.size() && used == metrics.size(), name + ".metrics",
                  "has another number of cells or metrics");
}

}  // namespace controlspace
