#include "baselines/openvdb/level_state.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

namespace controlspace {

namespace {

using Coord = openvdb::Coord;
using Leaf = VdbLevelTree::LeafNodeType;
using Words = std::array<std::uint32_t, 4>;

static_assert(Leaf::SIZE == 64, "the mask of a leaf is one number");

constexpr openvdb::Index leaf_level = Leaf::LEVEL;

/// What a stack consists of. A leaf is its grid and its origin; a tile has, above the grid in the
/// same word, its level in the tree and whether it is active.
struct LevelArrays {
    std::vector<Words> leaves;
    std::vector<std::uint64_t> active;
    std::vector<Metric> values;  // of all voxels, leaf by leaf
    std::vector<Words> tiles;
    std::vector<Metric> tile_values;

    template <class Self, class State>
    static void exchange(Self& self, const std::string& name, State& state) {
        state(name + ".leaves", self.leaves);
        state(name + ".active", self.active);
        state(name + ".values", self.values);
        state(name + ".tiles", self.tiles);
        state(name + ".tile_values", self.tile_values);
    }
};

struct TileHead {
    std::uint32_t grid = 0;
    openvdb::Index level = 0;
    bool active = false;

    static TileHead from_word(std::uint32_t word) {
        return {word & 0xff, word >> 8 & 0xff, word >> 16 != 0};
    }
    std::uint32_t word() const { return grid | level << 8 | (active ? 1u << 16 : 0); }
};

Words words(std::uint32_t head, const Coord& c) {
    return {head, static_cast<std::uint32_t>(c.x()), static_cast<std::uint32_t>(c.y()),
            static_cast<std::uint32_t>(c.z())};
}
Coord coord(const Words& words) {
    return {static_cast<openvdb::Int32>(words[1]), static_cast<openvdb::Int32>(words[2]),
            static_cast<openvdb::Int32>(words[3])};
}

bool means_something(const Metric& m) { return m != no_metric.metric; }

void append(const VdbLevelTree& tree, std::uint32_t grid, LevelArrays& arrays) {
    for (auto leaf = tree.cbeginLeaf(); leaf; ++leaf) {
        arrays.leaves.push_back(words(grid, leaf->origin()));
        arrays.active.push_back(leaf->getValueMask().getWord<std::uint64_t>(0));
        for (openvdb::Index i = 0; i < Leaf::SIZE; ++i) {
            arrays.values.push_back(leaf->getValue(i).metric);
        }
    }
    auto tile = tree.cbeginValueAll();
    tile.setMaxDepth(VdbLevelTree::ValueAllCIter::LEAF_DEPTH - 1);
    for (; tile; ++tile) {
        const Metric& metric = (*tile).metric;
        if (!tile.isValueOn() && !means_something(metric)) continue;
        const TileHead head{grid, tile.getLevel(), tile.isValueOn()};
        arrays.tiles.push_back(words(head.word(), tile.getCoord()));
        arrays.tile_values.push_back(metric);
    }
}

/// Whether the cells that answer fill a cell of a level once, and have metrics; counts them.
template <class Values>
bool is_filled(const LevelReader& at, int level, const Coord& c, std::uint64_t& count) {
    if (at[level].isValueOn(c)) {
        ++count;
        bool holds = true;
        Values::for_each_metric(at, level, c,
                                [&](const Metric& m) { holds = holds && means_something(m); });
        return holds;
    }
    if (level == 0) return false;
    for (int i = 0; i < 8; ++i) {
        if (!is_filled<Values>(at, level - 1, (c << 1) + corner_step(i), count)) return false;
    }
    return true;
}

template <class Values>
bool is_filled(const LevelReader& at, const LevelCells& cells, std::uint64_t& count) {
    const Coord n = cells.cells_of(cells.top());
    for (int k = 0; k < n.z(); ++k) {
        for (int j = 0; j < n.y(); ++j) {
            for (int i = 0; i < n.x(); ++i) {
                if (!is_filled<Values>(at, cells.top(), {i, j, k}, count)) return false;
            }
        }
    }
    return true;
}

}  // namespace

void save_levels(std::span<const VdbLevelTree> trees, const std::string& name, StateWriter& state) {
    LevelArrays arrays;
    for (std::size_t grid = 0; grid < trees.size(); ++grid) {
        append(trees[grid], static_cast<std::uint32_t>(grid), arrays);
    }
    LevelArrays::exchange(arrays, name, state);
}

void load_levels(std::span<VdbLevelTree> trees, const std::string& name, const LevelCells& cells,
                 Interpolation interpolation, const StateReader& state) {
    LevelArrays arrays;
    LevelArrays::exchange(arrays, name, state);
    const bool fit = arrays.active.size() == arrays.leaves.size() &&
                     arrays.values.size() == arrays.leaves.size() * Leaf::SIZE &&
                     arrays.tile_values.size() == arrays.tiles.size();
    state.require(fit, name, "has leaves or tiles without values");
    for (const auto* metrics : {&arrays.values, &arrays.tile_values}) {
        const bool are_metrics = std::all_of(metrics->begin(), metrics->end(), [](const Metric& m) {
            return !means_something(m) || is_positive_definite(m);
        });
        state.require(are_metrics, name, "holds what is no metric");
    }
    // Vertices have places beyond the last cells.
    const auto is_inside = [&](std::uint32_t grid, const Coord& c) {
        return grid < trees.size() && c == (c & ~(Leaf::DIM - 1)) &&
               openvdb::CoordBBox({}, cells.cells_of(static_cast<int>(grid))).isInside(c);
    };
    for (std::size_t i = 0; i < arrays.tiles.size(); ++i) {
        const auto head = TileHead::from_word(arrays.tiles[i].front());
        const Coord origin = coord(arrays.tiles[i]);
        state.require(is_inside(head.grid, origin) && head.level > leaf_level &&
                          head.level < VdbLevelTree::DEPTH,
                      name, "has a tile out of place");
        trees[head.grid].addTile(head.level, origin, VdbMetric(arrays.tile_values[i]), head.active);
    }
    for (std::size_t i = 0; i < arrays.leaves.size(); ++i) {
        const std::uint32_t grid = arrays.leaves[i].front();
        const Coord origin = coord(arrays.leaves[i]);
        state.require(is_inside(grid, origin), name, "has a leaf out of place");
        Leaf& leaf = *trees[grid].touchLeaf(origin);
        for (openvdb::Index k = 0; k < Leaf::SIZE; ++k) {
            leaf.setValueOnly(k, VdbMetric(arrays.values[i * Leaf::SIZE + k]));
            leaf.setActiveState(k, (arrays.active[i] >> k & 1) != 0);
        }
    }
    std::uint64_t active = 0;
    for (const VdbLevelTree& tree : trees) active += tree.activeVoxelCount();
    std::uint64_t count = 0;
    const LevelReader at(trees);
    const bool filled = interpolation == Interpolation::nearest
                            ? is_filled<CellMetrics>(at, cells, count)
                            : is_filled<VertexMetrics>(at, cells, count);
    state.require(filled && count == active, name, "has cells that do not fill the domain once");
}

}  // namespace controlspace
