#include "baselines/openvdb/level_values.h"

#include <optional>

namespace controlspace {

namespace {

using Coord = openvdb::Coord;

/// visit(c) for the `n` places from the origin on, x fastest.
template <class Visit>
void for_each_place(const Coord& n, Visit&& visit) {
    for (int k = 0; k < n.z(); ++k) {
        for (int j = 0; j < n.y(); ++j) {
            for (int i = 0; i < n.x(); ++i) visit(Coord(i, j, k));
        }
    }
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

bool is_corner_of_active(const LevelWriter& at, int level, const Coord& vertex) {
    for (int i = 0; i < 8; ++i) {
        if (at[level].isValueOn(vertex - corner_step(i))) return true;
    }
    return false;
}

Metric blended(const std::array<Metric, 8>& corners, const std::array<double, 3>& high) {
    return blend_lengths(trilinear_weights(high),
                         [&](std::size_t i) -> const Metric& { return corners[i]; });
}

}  // namespace

void CellMetrics::fill(LevelWriter& at, const LevelCells& cells, const Metric& metric) {
    const int top = cells.top();
    for_each_place(cells.cells_of(top),
                   [&](const Coord& c) { at[top].setValueOn(c, VdbMetric(metric)); });
}

void CellMetrics::split(LevelWriter& at, int level, const Coord& c) {
    const VdbMetric inherited = at[level].getValue(c);
    at[level].setValueOff(c, no_metric);
    for (int i = 0; i < 8; ++i) at[level - 1].setValueOn((c << 1) + corner_step(i), inherited);
}

void CellMetrics::lower(LevelWriter& at, int level, const Coord& c, const Metric& metric) {
    at[level].setValueOnly(c, VdbMetric(intersection(at.metric(level, c), metric)));
}

Metric VertexMetrics::value(const LevelReader& at, int level, const Coord& c,
                            const std::array<double, 3>& t) {
    const double cells_per_finest = 1.0 / (1 << level);
    const std::array<double, 3> high{t[0] * cells_per_finest - c.x(),
                                     t[1] * cells_per_finest - c.y(),
                                     t[2] * cells_per_finest - c.z()};
    return blend_lengths(trilinear_weights(high), [&](std::size_t i) -> const Metric& {
        return at.metric(level, c + corner_step(static_cast<int>(i)));
    });
}

void VertexMetrics::fill(LevelWriter& at, const LevelCells& cells, const Metric& metric) {
    const int top = cells.top();
    const Coord n = cells.cells_of(top);
    for_each_place(n.offsetBy(1),
                   [&](const Coord& c) { at[top].setValueOnly(c, VdbMetric(metric)); });
    for_each_place(n, [&](const Coord& c) { at[top].setActiveState(c, true); });
}

void VertexMetrics::split(LevelWriter& at, int level, const Coord& c) {
    std::array<Metric, 8> corners;
    for (int i = 0; i < 8; ++i) {
        corners[static_cast<std::size_t>(i)] = at.metric(level, c + corner_step(i));
    }
    for_each_place({3, 3, 3}, [&](const Coord& step) {
        const Coord vertex = (c << 1) + step;
        Metric metric = blended(corners, {0.5 * step.x(), 0.5 * step.y(), 0.5 * step.z()});
        if (const auto held = held_at(at, level - 1, vertex)) {
            // Corners of the cell among them: they are held as they are.
            metric = intersection(*held, metric);
            set_copies(at, level - 1, vertex, metric);
        }
        at[level - 1].setValueOnly(vertex, VdbMetric(metric));
    });
    at[level].setActiveState(c, false);
    for (int i = 0; i < 8; ++i) at[level - 1].setActiveState((c << 1) + corner_step(i), true);
    for (int i = 0; i < 8; ++i) {
        const Coord vertex = c + corner_step(i);
        if (!is_corner_of_active(at, level, vertex)) at[level].setValueOnly(vertex, no_metric);
    }
}

void VertexMetrics::lower(LevelWriter& at, int level, const Coord& c, const Metric& metric) {
    for (int i = 0; i < 8; ++i) {
        const Coord vertex = c + corner_step(i);
        set_copies(at, level, vertex, intersection(at.metric(level, vertex), metric));
    }
}

}  // namespace controlspace
