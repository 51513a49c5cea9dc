// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <vector>

#include "controlspace/geometry/box.h"
#include "controlspace/geometry/subdivision.h"
#include "geometry/large_pages.h"
#include "trees/topology/cell_steps.h"
#include "trees/topology/work_through.h"

namespace controlspace {

/// A coarse uniform grid over a tree that starts descents near their end: each cell holds the
/// deepest part of the tree (a `Ref`) that contains all of it.
///
/// As in a tree, a place on a plane belongs to the low side. The planes come of the same halving as
/// a tree's, bit for bit, so that the cells of trees that are cut in the middle lie in one leaf, or
/// contain whole ones.
template <class Ref>
class JumpTable {
public:
    /// One cell: the root.
    explicit JumpTable(const Box& domain) : domain_(domain) {
        for (Axis a = 0; a < 3; ++a) axes_[index(a)].cut(domain.low[a], domain.high[a], 1);
        count_steps();
    }

    /// As many cells as leaves of the deepest tree that is cut evenly, by `subdivide(box, level)`,
    /// and halved no more often than that. False if they are so many already; otherwise nothing is
    /// entered.
    template <class Subdivide>
    bool resize(int halvings, Subdivide&& subdivide) {
        std::array<int, 3> cells{1, 1, 1};
        Box cell = domain_;
        for (int level = 0;; ++level) {
            const Subdivision subdivision = subdivide(cell, level);
            halvings -= std::countr_zero(static_cast<unsigned>(subdivision.children()));
            if (halvings < 0) break;
            cell = subdivision.child(0);
            for (Axis a = 0; a < 3; ++a) cells[index(a)] *= subdivision.cuts[index(a)] ? 2 : 1;
        }
        const std::size_t all = static_cast<std::size_t>(cells[0]) *
                                static_cast<std::size_t>(cells[1]) *
                                static_cast<std::size_t>(cells[2]);
        if (all == refs_.size()) return false;
        for (Axis a = 0; a < 3; ++a) {
            axes_[index(a)].cut(domain_.low[a], domain_.high[a], cells[index(a)]);
        }
        count_steps();
        refs_ = {};  // so that both are never there together
        refs_ = large_array<Ref>(all);
        return true;
    }

    /// The cells along one axis. The outermost planes are no numbers: nothing lies beyond them.
    struct AxisCells {
        double low = 0;
        double per_length = 0;
        std::vector<double> planes;

        int count() const { return static_cast<int>(planes.size()) - 1; }

        void cut(double from, double to, int cells) {
            low = from;
            per_length = to > from ? cells / (to - from) : 0;
            planes.resize(static_cast<std::size_t>(cells) + 1);
            planes.front() = from;
            planes.back() = to;
            for (int step = cells; step > 1; step /= 2) {
                for (int i = 0; i < cells; i += step) {
                    const double sum = planes[at(i)] + planes[at(i + step)];
                    planes[at(i + step / 2)] = 0.5 * sum;
                }
            }
            planes.front() = planes.back() = std::numeric_limits<double>::quiet_NaN();
        }

        /// Most that the quotient at a plane is off from the plane's number.
        double largest_error() const {
            double error = 0;
            for (int i = 1; i < count(); ++i) {
                error = std::max(error, std::abs((planes[at(i)] - low) * per_length - i));
            }
            return error;
        }

        // The quotient is off by rounding at most, and brought to the planes' own order.
        int find(double x) const {
            double guess = (x - low) * per_length;
            const double most = count() - 1;
            guess = guess > 0 ? guess : 0;
            guess = guess < most ? guess : most;
            const int i = static_cast<int>(guess);
            return i + (x > planes[at(i + 1)] ? 1 : 0) - (x <= planes[at(i)] ? 1 : 0);
        }

        /// First cell that begins at `x` or above; the end of the last that ends at `x` or below.
        int first_from(double x) const {
            const auto found = std::lower_bound(planes.begin() + 1, planes.end() - 1, x);
            return static_cast<int>(found - planes.begin());
        }
        int last_to(double x) const {
            const auto found = std::upper_bound(planes.begin() + 1, planes.end() - 1, x);
            return static_cast<int>(found - planes.begin()) - 1;
        }

        static std::size_t at(int i) { return static_cast<std::size_t>(i); }
    };

    const std::array<AxisCells, 3>& axes() const { return axes_; }
    /// Of the cells, x fastest.
    std::span<const Ref> refs() const { return refs_; }
    std::size_t cells() const { return refs_.size(); }
    std::size_t bytes() const {
        std::size_t sum = refs_.capacity() * sizeof(Ref);
        for (const AxisCells& axis : axes_) sum += axis.planes.capacity() * sizeof(double);
        return sum;
    }

    /// Where a descent to `x` may start.
    Ref at(const Point& x) const { return at(steps_.find(x), x); }

    /// Numbers of the cells that hold places, for `at`; see CellSteps::find.
    void find(std::span<const Point> x, std::span<int> cells) const { steps_.find(x, cells); }
    Ref at(int cell, const Point& x) const {
        return refs_[cell >= 0 ? static_cast<std::size_t>(cell) : cell_by_planes(x)];
    }

    /// Enters `ref`, which stands for `box`, for all cells inside; or what is deeper down.
    /// `node_of(ref)` is the inner node of a reference. Parts that have no place in common may be
    /// entered at the same time.
    template <class NodeOf>
    void enter(Ref ref, const Box& box, const NodeOf& node_of) {
        if (may_hold_cells(box)) enter(cells_in({ref, box, {}}), node_of);
    }
    /// The same for a whole tree, on all threads.
    template <class NodeOf>
    void enter_all(Ref root, const NodeOf& node_of) {
        work_through(cells_in({root, domain_, {}}), [&](const Part& part, auto&& next) {
            enter_own(part, node_of, [&](const Part& child) {
                if (!child.ref.is_leaf()) __builtin_prefetch(&node_of(child.ref));
                next(child);
            });
        });
    }

private:
    static std::size_t index(Axis a) { return static_cast<std::size_t>(a); }

    void count_steps() {
        std::array<CellSteps::Axis, 3> axes;
        std::transform(axes_.begin(), axes_.end(), axes.begin(), [](const AxisCells& axis) {
            return CellSteps::Axis{axis.low, axis.per_length, axis.count(), axis.largest_error()};
        });
        steps_ = CellSteps(axes);
    }

    // Whether the box is as long as a cell along all axes, or shorter by rounding alone.
    bool may_hold_cells(const Box& box) const {
        constexpr double shortest = 0.99;  // in cells
        for (Axis a = 0; a < 3; ++a) {
            const double length = box.high[a] - box.low[a];
            const AxisCells& axis = axes_[index(a)];
            if (axis.per_length > 0 && length * axis.per_length < shortest) return false;
        }
        return true;
    }

    struct Range {
        std::array<int, 3> first{};
        std::array<int, 3> last{};
        bool is_empty() const {
            return first[0] >= last[0] || first[1] >= last[1] || first[2] >= last[2];
        }
    };

    /// Part of the tree with the cells inside of it.
    struct Part {
        Ref ref;
        Box box;
        Range cells;
    };

    std::size_t cell_by_planes(const Point& x) const {
        return cell(axes_[0].find(x.x()), axes_[1].find(x.y()), axes_[2].find(x.z()));
    }
    std::size_t cell(int i, int j, int k) const {
        const auto row = static_cast<std::size_t>(k) * static_cast<std::size_t>(axes_[1].count()) +
                         static_cast<std::size_t>(j);
        return row * static_cast<std::size_t>(axes_[0].count()) + static_cast<std::size_t>(i);
    }

    void set(const Range& range, Ref ref) {
        for (int k = range.first[2]; k < range.last[2]; ++k) {
            for (int j = range.first[1]; j < range.last[1]; ++j) {
                for (int i = range.first[0]; i < range.last[0]; ++i) refs_[cell(i, j, k)] = ref;
            }
        }
    }

    // All cells that lie in the box of `part`.
    Part cells_in(Part part) const {
        for (Axis a = 0; a < 3; ++a) {
            const AxisCells& axis = axes_[index(a)];
            const Box& box = part.box;
            part.cells.first[index(a)] =
                box.low[a] <= domain_.low[a] ? 0 : axis.first_from(box.low[a]);
            part.cells.last[index(a)] =
                box.high[a] >= domain_.high[a] ? axis.count() : axis.last_to(box.high[a]);
        }
        return part;
    }

    template <class NodeOf>
    void enter(const Part& part, const NodeOf& node_of) {
        enter_own(part, node_of, [&](const Part& child) { enter(child, node_of); });
    }

    // Enters a part for the cells that no child of it has to itself; calls next(child) for children
    // that have some.
    template <class NodeOf, class Next>
    void enter_own(const Part& part, const NodeOf& node_of, Next&& next) {
        const Range& range = part.cells;
        if (part.ref.is_leaf()) {
            set(range, part.ref);
            return;
        }
        const auto& node = node_of(part.ref);
        const Subdivision subdivision = node.subdivision(part.box);
        std::array<int, 3> low_end = range.last;
        std::array<int, 3> high_begin = range.last;
        for (Axis a = 0; a < 3; ++a) {
            if (!subdivision.cuts[index(a)]) continue;
            const double plane = subdivision.at[a];
            low_end[index(a)] = std::max(axes_[index(a)].last_to(plane), range.first[index(a)]);
            high_begin[index(a)] =
                std::min(axes_[index(a)].first_from(plane), range.last[index(a)]);
            if (low_end[index(a)] >= high_begin[index(a)]) continue;
            Range cut_through = range;  // cells on both sides of the plane
            cut_through.first[index(a)] = low_end[index(a)];
            cut_through.last[index(a)] = high_begin[index(a)];
            set(cut_through, part.ref);
        }
        for (int c = 0; c < subdivision.children(); ++c) {
            Range cells = range;
            for (Axis a = 0; a < 3; ++a) {
                if (!subdivision.cuts[index(a)]) continue;
                if (subdivision.side(c, a) == 0) {
                    cells.last[index(a)] = low_end[index(a)];
                } else {
                    cells.first[index(a)] = high_begin[index(a)];
                }
            }
            if (cells.is_empty()) continue;
            next({node.children[node.slot(c)], subdivision.child(c), cells});
        }
    }

    Box domain_;
    std::array<AxisCells, 3> axes_;
    CellSteps steps_;
    std::vector<Ref> refs_{Ref()};
};

}  // namespace controlspace
