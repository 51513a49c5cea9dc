#include "baselines/openvdb/level_values.h"

#include <array>
#include <optional>

#include "controlspace/metric/blend.h"
#include "controlspace/metric/intersection.h"

namespace controlspace {

namespace {

using Coord = openvdb::Coord;

/// The `n` places from the origin on, x fastest.
openvdb::CoordBBox::Iterator<false> places(const Coord& n) {
    return openvdb::CoordBBox({}, n.offsetBy(-1)).beginXYZ();
}

/// visit(level, c) for the places of all levels where a vertex of level `own` stands.
template <class Visit>
void for_each_copy(int levels, int own, const Coord& vertex, Visit&& visit) {
    const Coord finest = vertex << static_cast<std::size_t>(own);
    for (int level = 0; level < levels; ++level) {
        const auto l = static_cast<std::size_t>(level);
        if ((finest >> l) << l != finest) return;
        visit(level, finest >> l);
    }
}

std::optional<Metric> held_at(const LevelWriter& at, int level, const Coord& vertex) {
    std::optional<Metric> held;
    for_each_copy(at.levels(), level, vertex, [&](int l, const Coord& c) {
        if (held) return;
        const VdbMetric& value = at[l].getValue(c);
        if (value != no_metric) held = value.metric;
    });
    return held;
}

void set_copies(LevelWriter& at, int level, const Coord& vertex, const Metric& metric) {
    for_each_copy(at.levels(), level, vertex, [&](int l, const Coord& c) {
        if (at[l].getValue(c) != no_metric) at[l].setValueOnly(c, VdbMetric(metric));
    });
}

// Whether the voxel belongs to an active cell.
template <std::size_t corners>
bool is_needed(const LevelWriter& at, int level, const Coord& c) {
    for (std::size_t i = 0; i < corners; ++i) {
        if (at[level].isValueOn(c - corner_step(i))) return true;
    }
    return false;
}

}  // namespace

template <std::size_t corner_count>
void LevelMetrics<corner_count>::fill(LevelWriter& at, const LevelCells& cells,
                                      const Metric& metric) {
    auto& nodes = at[cells.top()];
    const Coord n = cells.cells_of(cells.top());
    for (auto c = places(corners == 1 ? n : n + cells.step(7)); c; ++c) {
        nodes.setValueOnly(*c, VdbMetric(metric));
    }
    for (auto c = places(n); c; ++c) nodes.setActiveState(*c, true);
}

template <std::size_t corner_count>
void LevelMetrics<corner_count>::split(LevelWriter& at, const LevelCells& cells, int level,
                                       const Coord& c) {
    std::array<Metric, corners> own;
    for (std::size_t i = 0; i < corners; ++i) own[i] = at.metric(level, c + cells.step(i));
    for (auto place = places(cells.places(corners == 1 ? 2 : 3)); place; ++place) {
        const Coord step = *place, part = (c << 1) + step;
        Metric metric = own[0];
        if constexpr (corners > 1) {
            metric =
                blend_lengths(trilinear_weights({0.5 * step.x(), 0.5 * step.y(), 0.5 * step.z()}),
                              [&](std::size_t i) -> const Metric& { return own[i]; });
            if (const auto held = held_at(at, level - 1, part)) {
                // Corners of the cell among them: they are held as they are.
                metric = intersection(*held, metric);
                set_copies(at, level - 1, part, metric);
            }
        }
        at[level - 1].setValueOnly(part, VdbMetric(metric));
    }
    at[level].setActiveState(c, false);
    for (std::size_t i = 0; i < 8; ++i) {
        at[level - 1].setActiveState((c << 1) + cells.step(i), true);
    }
    for (std::size_t i = 0; i < corners; ++i) {
        const Coord node = c + cells.step(i);
        if (!is_needed<corners>(at, level, node)) at[level].setValueOnly(node, no_metric);
    }
}

template <std::size_t corner_count>
void LevelMetrics<corner_count>::lower(LevelWriter& at, const LevelCells& cells, int level,
                                       const Coord& c, const Metric& metric) {
    for (std::size_t i = 0; i < corners; ++i) {
        if (!cells.has_part(i)) continue;
        const Coord node = c + cells.step(i);
        set_copies(at, level, node, intersection(at.metric(level, node), metric));
    }
}

template struct LevelMetrics<1>;
template struct LevelMetrics<8>;

}  // namespace controlspace
