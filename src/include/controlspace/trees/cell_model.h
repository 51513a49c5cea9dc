// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <utility>
#include <vector>

#include "controlspace/geometry/box.h"
#include "controlspace/geometry/subdivision.h"
#include "controlspace/gradation/node_graph.h"
#include "controlspace/metric/metric.h"
#include "controlspace/space/control_space.h"
#include "controlspace/trees/leaf_arrays.h"
#include "controlspace/trees/node_metrics.h"

namespace controlspace {

class CellJudge;
class GoalField;
class NearbyField;

/// Number of a cell of a structure, from 0 on without gaps; of a leaf of a tree.
using CellIndex = std::uint32_t;
using LeafIndex = CellIndex;

/// The control nodes at the eight vertices of a cell, in the order of controlspace::corner.
using Corners = std::array<NodeIndex, 8>;

/// A cell and its box.
struct CellBox {
    CellIndex cell = 0;
    Box box;
};

/// Where in a cell the error of the interpolation is largest: adaptation chooses the axis of a cut
/// by it.
enum class CutBy {
    corners,      ///< constant in a cell: it differs between opposite corners
    faces,        ///< exact at the centre: it is large at the faces across the axis
    edges,        ///< exact at the corners: it is large in the middle of edges along the axis
    longest_edge  ///< it does not show
};

/// What is known of a model before anything is inserted.
struct ModelTraits {
    int order = 0;  ///< of interpolation: 0 constant in a cell, 1 linear, 2 quadratic
    CutBy cut_by = CutBy::longest_edge;
    /// The value in a cell depends on its neighbours' metrics.
    bool follows_neighbours = false;
    /// Where all metrics are isotropic, `lengths` needs no tensors.
    bool has_lengths = false;
    /// The metric in a cell is trilinear between its eight nodes.
    bool is_trilinear = false;
    /// How a tree inserts sources (paper §3.1).
    enum class Insertion : std::uint8_t {
        in_turn,  ///< one after the other: the value at a source depends on other cells too
        by_leaf,  ///< leaves grow independently of each other: a leaf is its own metric alone
        /// leaves grow likewise, with a metric each that their sources request; the nodes are set
        /// to these afterwards (LeafModel::collect)
        collected
    };
    Insertion insertion = Insertion::in_turn;
};

/// How a cell compares with a field (CellModel::judge).
struct Judgement {
    enum class Verdict : std::uint8_t {
        kept,      ///< `delta` is the largest that was found, or an upper bound of all
        exceeded,  ///< `delta`, above the target, is found at `where`
        unknown    ///< bounds prove nothing, and no place above the target is known
    };
    Verdict verdict = Verdict::kept;
    double delta = 0;
    Point where = Point::Zero();
    std::array<double, 3> along{};  ///< how much speaks for a cut across each axis
};

/// A field that cells are to follow.
struct FieldToFit {
    const ControlSpace& field;
    const GoalField& goal;  ///< the same, as the library's models evaluate it
    /// Cells will also be judged at places that they are not fitted to.
    bool is_searched = true;
};

/// What the cells of a structure hold, and how it follows a field: all that needs no neighbours.
///
/// A model has metrics at control nodes. Those of a cell are a node of its own number, at the
/// centre of the cell; or eight, at its vertices, which cells share: corners() and positions() list
/// them. Functions with a body are overridden where a model does better, or holds more than
/// metrics.
class CellModel {
public:
    virtual ~CellModel() = default;

    const ModelTraits& traits() const { return traits_; }
    NodeMetrics& metrics() { return metrics_; }
    const NodeMetrics& metrics() const { return metrics_; }

    /// Of all cells, and of all nodes; empty where a cell has one node.
    virtual std::span<const Corners> corners() const { return {}; }
    virtual std::span<const Point> positions() const { return {}; }

    /// The effect of a cut: child 0 keeps the cell's number, children 1, 2, ... get first_new,
    /// first_new + 1, ... The field gets nowhere longer.
    virtual void split(const Subdivision& subdivision, CellIndex cell, CellIndex first_new) = 0;

    /// Intersects the nodes of a cell with the metric of a source in it. The field at the source
    /// must not be longer than that afterwards, and nowhere longer than before.
    virtual void lower(const CellBox& cell, const Metric& metric);
    /// Metrics were set from outside.
    virtual void assigned() {}
    /// All metrics were graded with this ratio, or fitted to a field of it.
    virtual void graded(double /*ratio*/) {}

    // Adaptation: a loop that fits cells, judges them, and improves or cuts those that are not
    // kept.

    /// Sets nodes and arrays of some cells to a field: by default the nodes. Where bounds of the
    /// field, which hold everywhere in a cell, show at once how well that follows it: a judgement
    /// for each cell, which are not judged otherwise then.
    virtual std::vector<Judgement> fit(std::span<const CellBox> cells, const FieldToFit& to);
    /// Whether bounds of the field decide on cells, here or in `fit`: what is kept is proven then.
    virtual bool has_bounds(const GoalField& /*field*/) const { return false; }
    /// Whether a fitted cell is known to follow the field at the places that it was fitted to.
    virtual bool is_fitted(CellIndex /*cell*/) const { return false; }
    /// Compares a cell with the field. By default the error is sampled (CellJudge::by_samples).
    virtual Judgement judge(const CellBox& cell, CellJudge& judge) const;

    /// Whether cells may be brought nearer to the field without a cut (`improvement`).
    virtual bool improves() const { return false; }
    /// What `improve` needs so that the cell follows the field at x, as numbers that the model
    /// understands; empty where nothing helps. For several cells at the same time.
    virtual std::vector<std::uint32_t> improvement(CellIndex /*cell*/, const Point& /*x*/,
                                                   NearbyField& /*nearby*/,
                                                   const GoalField& /*field*/) const {
        return {};
    }
    virtual void improve(CellIndex /*cell*/, std::span<const std::uint32_t> /*improvement*/) {}

    // Files and memory.

    /// Visits the arrays beside the metrics that have an entry for each cell, and single numbers,
    /// by their names in files. Saving, loading, footprints, compact forms are made of it.
    virtual void arrays(LeafArrays& /*visitor*/) {}
    virtual void describe(Footprint& footprint) const;
    virtual void shrink_to_fit();

protected:
    CellModel(const ModelTraits& traits, NodeMetrics metrics)
        : traits_(traits), metrics_(std::move(metrics)) {}
    CellModel(const CellModel&) = default;
    CellModel& operator=(const CellModel&) = default;

    ModelTraits traits_;
    NodeMetrics metrics_;
};

/// Calls visit(cell) for all, on all threads: for CellModel::fit.
void for_each_cell(std::span<const CellBox> cells,
                   const std::function<void(const CellBox&)>& visit);

}  // namespace controlspace
