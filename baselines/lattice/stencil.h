// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>

#include "baselines/lattice/voxels.h"
#include "controlspace/geometry/extent.h"
#include "controlspace/gradation/node_graph.h"
#include "controlspace/metric/blend.h"

namespace controlspace {

/// Numbers of a cell along x, y and z.
using Cell = std::array<std::int32_t, 3>;

/// Cells of some points at once, found in vectors, and the points themselves in units of cells.
struct CellBatch {
    static constexpr std::size_t most = 32;  // what the corners' metrics take fits the first cache

    std::array<std::array<std::int32_t, most>, 3> cell;
    std::array<std::array<double, most>, 3> t;

    Cell operator[](std::size_t i) const { return {cell[0][i], cell[1][i], cell[2][i]}; }
};

/// Equal cells that fill a box. Points outside the domain are taken as the nearest point of it,
/// which clamping each coordinate gives; not-a-number counts as the low side.
class CellsOfBox {
public:
    CellsOfBox(const Box& domain, const Vector& cells)
        : domain_(domain),
          cells_(cells),
          per_length_(cells.cwiseQuotient(divisible_edges(domain))),
          high_corner_{domain.low.x() < domain.high.x(), domain.low.y() < domain.high.y(),
                       domain.low.z() < domain.high.z()} {
        // Places beside a flat domain are at its one layer, wherever the high side is read from.
        if (const auto flat = flat_axis(domain)) per_length_[*flat] = 0;
    }

    const Box& domain() const { return domain_; }
    const Vector& cells() const { return cells_; }

    Box box_of(const Cell& cell) const {
        Box box;
        const Vector edges = domain_.edges().cwiseQuotient(cells_);
        for (Axis a = 0; a < 3; ++a) {
            const std::int32_t i = cell[static_cast<std::size_t>(a)];
            box.low[a] = domain_.low[a] + i * edges[a];
            box.high[a] = domain_.low[a] + (i + 1) * edges[a];
        }
        return box;
    }
    /// The cell that answers for `x`; holds the place, whichever way its bounds are rounded.
    Box cell_at(const Point& x) const {
        Cell cell;
        for (Axis a = 0; a < 3; ++a) {
            cell[static_cast<std::size_t>(a)] =
                static_cast<std::int32_t>(cell_of(in_cells(x, a), a));
        }
        return widened(box_of(cell), x);
    }

    /// The cells of at most CellBatch::most points.
    void locate(std::span<const Point> x, CellBatch& batch) const {
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const auto a = static_cast<Axis>(axis);
            const double low = domain_.low[a], high = domain_.high[a];
            const double per_length = per_length_[a], n = cells_[a];
            for (std::size_t i = 0; i < x.size(); ++i) {
                const double t = in_cells(x[i][a], low, high, per_length, n);
                batch.t[axis][i] = t;
                batch.cell[axis][i] = static_cast<std::int32_t>(t < n ? t : n - 1);
            }
        }
    }

protected:
    /// The cell that `x` was found in, up to the place itself where rounding puts it outside.
    Box widened(const Box& cell, const Point& x) const {
        const Point place = nearest_in(domain_, x);
        return {cell.low.cwiseMin(place), cell.high.cwiseMax(place)};
    }
    /// `x` along axis `a` in units of cells, within [0, cells].
    double in_cells(const Point& x, Axis a) const {
        return in_cells(x[a], domain_.low[a], domain_.high[a], per_length_[a], cells_[a]);
    }
    /// The cell that holds `t`, which comes from `in_cells`; the last one for the high end.
    std::uint32_t cell_of(double t, Axis a) const {
        return static_cast<std::uint32_t>(t < cells_[a] ? t : cells_[a] - 1);
    }
    /// How many nodes corner `corner` of a cell is from its low one along axis `a`: 0 or 1.
    std::uint32_t step_to(std::size_t corner, std::size_t a) const {
        return static_cast<std::uint32_t>(corner >> a & 1) * high_corner_[a];
    }
    Lattice lattice_from(double first, Interpolation interpolation) const {
        const Vector spacing = domain_.edges().cwiseQuotient(cells_);
        const Vector nodes = lattice_nodes(domain_, cells_, interpolation);
        return {domain_.low + first * spacing,
                spacing,
                {static_cast<std::uint32_t>(nodes.x()), static_cast<std::uint32_t>(nodes.y()),
                 static_cast<std::uint32_t>(nodes.z())}};
    }

private:
    /// Clamped before it is scaled, so that a place outside is found where its nearest one is.
    [[gnu::always_inline]] static double in_cells(double x, double low, double high,
                                                  double per_length, double n) {
        const double above = x > low ? x : low;
        const double t = ((above < high ? above : high) - low) * per_length;
        return t < n ? t : n;
    }

    Box domain_;
    Vector cells_;
    Vector per_length_;
    std::array<std::uint32_t, 3> high_corner_;  // 0 where the domain is flat
};

/// Requests the cache lines of a value before it is read.
template <class Value>
[[gnu::always_inline]] inline void prefetch(const Value* value) {
    __builtin_prefetch(value);
    __builtin_prefetch(reinterpret_cast<const char*>(value + 1) - 1);
}

/// A metric, or with a `Value` of double its length.
template <class Value, class M>
[[gnu::always_inline]] inline Value answer_of(const M& m) {
    if constexpr (std::is_same_v<Value, double>) {
        return length_of(m);
    } else {
        return m;
    }
}

/// Answers `x` from the cells that locate(places, batch) finds, some places at a time, so that what
/// is stored is on its way while that before it is read: answer(at, batch, i) for place i. `read`
/// as of Stencil::sample.
template <std::size_t corners, class Value, class Reader, class Locate, class Answer>
void sample_cells(std::span<const Point> x, const Reader& read, std::span<Value> out,
                  const Locate& locate, const Answer& answer) {
    using Hint = decltype(read.prepare(Cell()));
    using At = decltype(read.template find<corners>(Cell(), Hint()));
    CellBatch batch;
    std::array<Hint, CellBatch::most> hints;
    std::array<At, CellBatch::most> at;
    for (std::size_t first = 0; first < x.size(); first += CellBatch::most) {
        const std::size_t count = std::min(CellBatch::most, x.size() - first);
        locate(x.subspan(first, count), batch);
        for (std::size_t i = 0; i < count; ++i) hints[i] = read.prepare(batch[i]);
        for (std::size_t i = 0; i < count; ++i) {
            at[i] = read.template find<corners>(batch[i], hints[i]);
        }
        for (std::size_t i = 0; i < count; ++i) out[first + i] = answer(at[i], batch, i);
    }
}

/// Which nodes of a grid answer for a point, and how. Nearest: nodes stand at the cells' centres,
/// and the cell's own answers; on the face of two cells the high one. Trilinear: nodes stand at the
/// cells' vertices, and the eight of the cell are blended, linear in M.
template <Interpolation kind>
class Stencil : public CellsOfBox {
public:
    static constexpr Interpolation interpolation = kind;
    /// Nodes that answer for a point.
    static constexpr std::size_t corners = kind == Interpolation::nearest ? 1 : 8;
    using CellsOfBox::CellsOfBox;

    Lattice lattice() const {
        return lattice_from(kind == Interpolation::nearest ? 0.5 : 0, interpolation);
    }

    /// Metric at x from nodes, read(i, j, k) -> const Metric& or Metric.
    template <class Read>
    Metric value(const Point& x, Read&& read) const {
        CellBatch batch;
        locate({&x, 1}, batch);
        if constexpr (corners == 1) {
            return at_corner(batch[0], 0, read);
        } else {
            return blend_lengths(weights(batch, 0), [&](std::size_t corner) -> decltype(auto) {
                return at_corner(batch[0], corner, read);
            });
        }
    }
    /// visit(i, j, k), the nodes that `value` reads.
    template <class Visit>
    void for_each_node(const Point& x, Visit&& visit) const {
        CellBatch batch;
        locate({&x, 1}, batch);
        for (std::size_t corner = 0; corner < corners; ++corner) at_corner(batch[0], corner, visit);
    }
    /// visit(i, j, k), the node at a corner of a cell.
    template <class Visit>
    decltype(auto) at_corner(const Cell& cell, std::size_t corner, Visit&& visit) const {
        const auto along = [&](std::size_t a) {
            return static_cast<std::uint32_t>(cell[a]) + step_to(corner, a);
        };
        return visit(along(0), along(1), along(2));
    }

    /// The metrics at `x`, or, with a `Value` of double, the lengths where all is isotropic.
    /// `read`, a storage's reader, provides
    ///   prepare(cell) -> hint            a first step to the nodes of a cell
    ///   find<corners>(cell, hint) -> at  where their metrics are, which it prefetches unless it is
    ///                                    find<corners, false>: they are read at once
    ///   metric(at, corner)               one of them, a Metric or what is stored in its place
    template <class Value, class Reader>
    void sample(std::span<const Point> x, const Reader& read, std::span<Value> out) const {
        sample_cells<corners>(
            x, read, out,
            [&](std::span<const Point> places, CellBatch& batch) { locate(places, batch); },
            [&](const auto& at, const CellBatch& batch, std::size_t i) {
                return between<Value>(read, at, [&] { return weights(batch, i); });
            });
    }

    /// The same at one place, without what only batches need.
    template <class Value, class Reader>
    Value at(const Point& x, const Reader& read) const {
        Cell cell;
        Vector t;
        for (Axis a = 0; a < 3; ++a) {
            const double in_cells = this->in_cells(x, a);
            const std::uint32_t i = cell_of(in_cells, a);
            cell[static_cast<std::size_t>(a)] = static_cast<std::int32_t>(i);
            t[a] = in_cells - i;
        }
        return between<Value>(read, read.template find<corners, false>(cell, read.prepare(cell)),
                              [&] { return corner_weights(t); });
    }

private:
    template <class Value, class Reader, class At, class Weights>
    [[gnu::always_inline]] static Value between(const Reader& read, const At& at,
                                                const Weights& weights) {
        if constexpr (corners == 1) {
            return answer_of<Value>(read.metric(at, 0));
        } else {
            const std::array<double, 8> weight = weights();
            return blend<Value>(
                8, [&](std::size_t corner) { return weight[corner]; },
                [&](std::size_t corner) -> decltype(auto) { return read.metric(at, corner); });
        }
    }
    static std::array<double, 8> weights(const CellBatch& batch, std::size_t i) {
        const auto high = [&](std::size_t a) { return batch.t[a][i] - batch.cell[a][i]; };
        return corner_weights({high(0), high(1), high(2)});
    }
};

using NearestStencil = Stencil<Interpolation::nearest>;
using TrilinearStencil = Stencil<Interpolation::trilinear>;

}  // namespace controlspace
