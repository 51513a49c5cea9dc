// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include "controlspace/trees/cell_model.h"

namespace controlspace {

/// The cells of a structure that is adapted to a field: the leaves of a tree.
class AdaptedCells {
public:
    virtual ~AdaptedCells() = default;

    virtual Box domain() const = 0;
    virtual std::size_t count() const = 0;
    /// Most cells that one becomes by a cut.
    virtual std::size_t most_parts() const = 0;
    /// A cut is across one axis, which is to be chosen; otherwise across all.
    bool chooses_axis() const { return most_parts() == 2; }

    /// Those that are wanted, in an order that depends on the structure alone.
    virtual std::vector<CellBox> where(const std::function<bool(CellIndex)>& is_wanted) const = 0;
    /// The cell that holds x.
    virtual CellBox at(const Point& x) const = 0;
    virtual CellIndex number_at(const Point& x) const = 0;

    /// What a cell answers at places in it, most_values at a time.
    static constexpr std::size_t most_values = 128;
    virtual void values(CellIndex cell, std::span<const Point> x, std::span<Metric> out) const = 0;
    Metric value(CellIndex cell, const Point& x) const {
        Metric m;
        values(cell, {&x, 1}, {&m, 1});
        return m;
    }

    virtual CellModel& model() = 0;
    virtual const CellModel& model() const = 0;
};

}  // namespace controlspace
