#pragma once

#include <openvdb/tree/ValueAccessor.h>

#include <array>
#include <span>
#include <vector>

#include "baselines/openvdb/level_cells.h"
#include "baselines/openvdb/openvdb_value.h"
#include "controlspace/metric/blend.h"
#include "controlspace/metric/intersection.h"

namespace controlspace {

/// A tree for a level that is not dense: leaves of 4^3 voxels below inner nodes of 8^3 and 8^3.
using VdbLevelTree = openvdb::tree::Tree4<VdbMetric, 3, 3, 2>::Type;

/// What stands where a level holds nothing; it is no metric.
inline const VdbMetric no_metric(0);

/// Accessors to all levels of a stack, the finest first; for one thread, and while no node of the
/// trees is taken away. Accessors that the trees need not know of ("unsafe"), since registering one
/// takes a lock and an allocation.
template <class Tree>
class LevelAccess {
public:
    using Coord = openvdb::Coord;
    using Accessor = openvdb::tree::ValueAccessor<Tree, false>;

    template <class Trees>
    explicit LevelAccess(Trees& trees) {
        levels_.reserve(trees.size());
        for (auto& tree : trees) levels_.emplace_back(tree);
    }

    int levels() const { return static_cast<int>(levels_.size()); }
    Accessor& operator[](int level) { return levels_[static_cast<std::size_t>(level)]; }
    const Accessor& operator[](int level) const { return levels_[static_cast<std::size_t>(level)]; }
    const Metric& metric(int level, const Coord& c) const {
        return (*this)[level].getValue(c).metric;
    }

    /// The level whose cell answers for a finest cell. From the coarsest: its nodes are few.
    int level_at(const Coord& finest) const {
        int level = levels() - 1;
        while (level > 0 && !(*this)[level].isValueOn(finest >> static_cast<std::size_t>(level))) {
            --level;
        }
        return level;
    }

private:
    std::vector<Accessor> levels_;
};
using LevelReader = LevelAccess<const VdbLevelTree>;
using LevelWriter = LevelAccess<VdbLevelTree>;

// How the levels of a stack hold metrics. In either way voxel c of a level is active if cell c is
// one that answers; over all levels those cells fill the domain once. What is asked of a way:
//   value(reader, level, c, t)       metric in the active cell c at the place t
//   for_each_metric(access, level, c, visit)   visit(metric) for those that the cell blends
//   fill(writer, cells, metric)      all cells of the coarsest level, and nothing else
//   split(writer, level, c)          c makes way for its eight parts; the field stays as it was
//   lower(writer, level, c, metric)  intersects what the cell blends with `metric`

/// A metric per cell, constant.
struct CellMetrics {
    static constexpr Interpolation interpolation = Interpolation::nearest;
    using Coord = openvdb::Coord;

    static Metric value(const LevelReader& at, int level, const Coord& c,
                        const std::array<double, 3>&) {
        return at.metric(level, c);
    }
    template <class Access, class Visit>
    static void for_each_metric(const Access& at, int level, const Coord& c, Visit&& visit) {
        visit(at.metric(level, c));
    }
    static void fill(LevelWriter& at, const LevelCells& cells, const Metric& metric);
    static void split(LevelWriter& at, int level, const Coord& c);
    static void lower(LevelWriter& at, int level, const Coord& c, const Metric& metric);
};

/// A metric per vertex, trilinear in a cell: voxel c of a level holds the metric of vertex c, and
/// does so where any of the eight cells around is active, active itself or not. So those beyond the
/// high side of active cells are a halo of inactive voxels. A vertex of several levels has a copy
/// in each, all of them equal. One that hangs on the side of a coarser cell has a metric of its
/// own, as in an octree.
struct VertexMetrics {
    static constexpr Interpolation interpolation = Interpolation::trilinear;
    using Coord = openvdb::Coord;

    static Metric value(const LevelReader& at, int level, const Coord& c,
                        const std::array<double, 3>& t);
    template <class Access, class Visit>
    static void for_each_metric(const Access& at, int level, const Coord& c, Visit&& visit) {
        for (int i = 0; i < 8; ++i) visit(at.metric(level, c + corner_step(i)));
    }
    static void fill(LevelWriter& at, const LevelCells& cells, const Metric& metric);
    static void split(LevelWriter& at, int level, const Coord& c);
    static void lower(LevelWriter& at, int level, const Coord& c, const Metric& metric);
};

}  // namespace controlspace
