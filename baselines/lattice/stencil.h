#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "baselines/lattice/voxels.h"
#include "controlspace/geometry/box.h"
#include "controlspace/gradation/node_graph.h"
#include "controlspace/metric/blend.h"

namespace controlspace {

/// A stencil says which nodes of a grid answer for a point, and how. Its contract:
///
///   static constexpr Interpolation interpolation
///   Stencil(const Box& domain, const Vector& cells)
///   const Box& domain(), const Vector& cells(), Lattice lattice()
///   Metric value(const Point& x, read)         from nodes, read(i, j, k) -> const Metric& or
///   Metric void for_each_node(const Point& x, visit)  visit(i, j, k), the nodes that `value` reads
///
/// Points outside the domain are taken as the nearest point of it, which clamping each coordinate
/// gives; not-a-number counts as the low side.
class CellsOfBox {
public:
    CellsOfBox(const Box& domain, const Vector& cells)
        : domain_(domain), cells_(cells), per_length_(cells.cwiseQuotient(domain.edges())) {}

    const Box& domain() const { return domain_; }
    const Vector& cells() const { return cells_; }

    /// The cell that holds `x`.
    Box cell_at(const Point& x) const {
        Box cell;
        for (Axis a = 0; a < 3; ++a) {
            const double edge = domain_.edges()[a] / cells_[a];
            const std::uint32_t i = cell_of(in_cells(x, a), a);
            cell.low[a] = domain_.low[a] + i * edge;
            cell.high[a] = domain_.low[a] + (i + 1) * edge;
        }
        return cell;
    }

protected:
    /// `x` along axis `a` in units of cells, within [0, cells].
    double in_cells(const Point& x, Axis a) const {
        const double t = (x[a] - domain_.low[a]) * per_length_[a];
        const double above = t > 0 ? t : 0;
        return above < cells_[a] ? above : cells_[a];
    }
    /// The cell that holds `t`, which comes from `in_cells`; the last one for the high end.
    std::uint32_t cell_of(double t, Axis a) const {
        return static_cast<std::uint32_t>(t < cells_[a] ? t : cells_[a] - 1);
    }
    Lattice lattice_from(double first, Interpolation interpolation) const {
        const Vector spacing = domain_.edges().cwiseQuotient(cells_);
        const Vector nodes = lattice_nodes(cells_, interpolation);
        return {domain_.low + first * spacing,
                spacing,
                {static_cast<std::uint32_t>(nodes.x()), static_cast<std::uint32_t>(nodes.y()),
                 static_cast<std::uint32_t>(nodes.z())}};
    }

private:
    Box domain_;
    Vector cells_;
    Vector per_length_;
};

/// Nodes at the cells' centres; the cell's node answers. On the face of two cells the high one.
class NearestStencil : public CellsOfBox {
public:
    static constexpr Interpolation interpolation = Interpolation::nearest;
    using CellsOfBox::CellsOfBox;

    Lattice lattice() const { return lattice_from(0.5, interpolation); }

    template <class Read>
    Metric value(const Point& x, Read&& read) const {
        return read(cell_of(in_cells(x, 0), 0), cell_of(in_cells(x, 1), 1),
                    cell_of(in_cells(x, 2), 2));
    }
    template <class Visit>
    void for_each_node(const Point& x, Visit&& visit) const {
        visit(cell_of(in_cells(x, 0), 0), cell_of(in_cells(x, 1), 1), cell_of(in_cells(x, 2), 2));
    }
};

/// Weights of a cell's corners for a place that is by `high`, 0 to 1 along each axis, off the low
/// one. Corner numbers as in geometry/box.h: bit 0 is the high side in x, bit 1 in y, bit 2 in z.
inline std::array<double, 8> trilinear_weights(const std::array<double, 3>& high) {
    const std::array<double, 3> low{1 - high[0], 1 - high[1], 1 - high[2]};
    const std::array<double, 4> xy{low[0] * low[1], high[0] * low[1], low[0] * high[1],
                                   high[0] * high[1]};
    return {xy[0] * low[2],  xy[1] * low[2],  xy[2] * low[2],  xy[3] * low[2],
            xy[0] * high[2], xy[1] * high[2], xy[2] * high[2], xy[3] * high[2]};
}

/// Nodes at the cells' vertices; the eight of the cell are blended, linear in M.
class TrilinearStencil : public CellsOfBox {
public:
    static constexpr Interpolation interpolation = Interpolation::trilinear;
    using CellsOfBox::CellsOfBox;

    Lattice lattice() const { return lattice_from(0, interpolation); }

    template <class Read>
    Metric value(const Point& x, Read&& read) const {
        std::array<double, 3> high;
        const Cell cell = locate(x, high);
        return blend_lengths(trilinear_weights(high), [&](std::size_t corner) -> decltype(auto) {
            return at_corner(cell, corner, read);
        });
    }
    template <class Visit>
    void for_each_node(const Point& x, Visit&& visit) const {
        std::array<double, 3> high;
        const Cell cell = locate(x, high);
        for (std::size_t corner = 0; corner < 8; ++corner) at_corner(cell, corner, visit);
    }

private:
    using Cell = std::array<std::uint32_t, 3>;

    /// The cell of `x`, and in `high` how far `x` is across it, 0 to 1 along each axis.
    Cell locate(const Point& x, std::array<double, 3>& high) const {
        Cell cell;
        for (Axis a = 0; a < 3; ++a) {
            const double t = in_cells(x, a);
            const auto i = static_cast<std::size_t>(a);
            cell[i] = cell_of(t, a);
            high[i] = t - cell[i];
        }
        return cell;
    }
    template <class Visit>
    static decltype(auto) at_corner(const Cell& cell, std::size_t corner, Visit&& visit) {
        const auto c = static_cast<std::uint32_t>(corner);
        return visit(cell[0] + (c & 1), cell[1] + (c >> 1 & 1), cell[2] + (c >> 2));
    }
};

}  // namespace controlspace
