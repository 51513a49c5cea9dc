#pragma once

#include <cstddef>
#include <vector>

#include "baselines/openvdb/dense_tree.h"
#include "baselines/openvdb/level_cells.h"
#include "baselines/openvdb/openvdb_value.h"

namespace controlspace {

/// A tree for a level that is not dense: leaves of 4^3 voxels below inner nodes of 8^3 and 8^3.
using VdbLevelTree = openvdb::tree::Tree4<VdbMetric, 3, 3, 2>::Type;

/// What stands where a level holds nothing; it is no metric.
inline const VdbMetric no_metric(0);

/// Accessors to all levels of a stack, the finest first.
template <class Tree>
class LevelAccess {
public:
    using Coord = openvdb::Coord;

    template <class Trees>
    explicit LevelAccess(Trees& trees) {
        levels_.reserve(trees.size());
        for (auto& tree : trees) levels_.emplace_back(tree);
    }

    int levels() const { return static_cast<int>(levels_.size()); }
    Accessor<Tree>& operator[](int level) { return levels_[static_cast<std::size_t>(level)]; }
    const Accessor<Tree>& operator[](int level) const {
        return levels_[static_cast<std::size_t>(level)];
    }
    const Metric& metric(int level, const Coord& c) const {
        return (*this)[level].getValue(c).metric;
    }

    /// The only level whose cell answers for a finest cell. `likely`, which may be that of a place
    /// near by, comes first; then, from the coarsest, whose nodes are few, the others.
    int level_at(const Coord& finest, int likely) const {
        if (is_active(finest, likely)) return likely;
        int level = levels() - 1;
        while (level > 0 && !is_active(finest, level)) --level;
        return level;
    }

private:
    bool is_active(const Coord& finest, int level) const {
        return (*this)[level].isValueOn(finest >> static_cast<std::size_t>(level));
    }

    std::vector<Accessor<Tree>> levels_;
};
using LevelReader = LevelAccess<const VdbLevelTree>;
using LevelWriter = LevelAccess<VdbLevelTree>;

/// How the levels of a stack hold metrics. Voxel c of a level is active if cell c answers; over all
/// levels those cells fill the domain once.
///
/// One corner: a metric per cell, constant. Eight: one per vertex, trilinear in a cell; voxel c
/// holds the metric of vertex c, and does so where any of the eight cells around is active, active
/// itself or not. So those beyond the high side of active cells are a halo of inactive voxels. A
/// vertex of several levels has a copy in each, all of them equal. One that hangs on the side of a
/// coarser cell has a metric of its own, as in an octree.
template <std::size_t corner_count>
struct LevelMetrics {
    using Coord = openvdb::Coord;

    static constexpr std::size_t corners = corner_count;
    static constexpr Interpolation interpolation =
        corners == 1 ? Interpolation::nearest : Interpolation::trilinear;

    /// visit(metric) for those that the cell blends.
    template <class Access, class Visit>
    static void for_each_metric(const Access& at, const LevelCells& cells, int level,
                                const Coord& c, Visit&& visit) {
        for (std::size_t i = 0; i < corners; ++i) visit(at.metric(level, c + cells.step(i)));
    }
    /// All cells of the coarsest level, and nothing else.
    static void fill(LevelWriter& at, const LevelCells& cells, const Metric& metric);
    /// The cell makes way for its parts; the field stays as it was.
    static void split(LevelWriter& at, const LevelCells& cells, int level, const Coord& c);
    /// Intersects what the cell blends with `metric`.
    static void lower(LevelWriter& at, const LevelCells& cells, int level, const Coord& c,
                      const Metric& metric);
};

extern template struct LevelMetrics<1>;
extern template struct LevelMetrics<8>;

}  // namespace controlspace
