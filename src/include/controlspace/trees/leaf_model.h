// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <span>
#include <utility>

#include "controlspace/metric/stored_metric.h"
#include "controlspace/space/control_space.h"
#include "controlspace/space/space_options.h"
#include "controlspace/trees/cell_model.h"

namespace controlspace {

class StateReader;
/// The inner nodes of trees: how a box is cut.
struct KdNode;
struct OctreeNode;
/// Where the leaves of a tree are.
template <class Node>
class Topology;

/// What the leaves of a tree hold: where its control nodes are, and how the metric between them is
/// interpolated. `Node` is how boxes are cut, KdNode or OctreeNode. Insertion (paper §3.1),
/// gradation (§3.2), adaptation, compact forms, files and footprints are made of a model
/// (tree_row.h). The simplest base for one from outside is LeafMetrics.
///
/// A new model, of a tree of one leaf, holds largest_metric(options).
template <class Node>
class LeafModel : public CellModel {
public:
    /// A copy.
    virtual std::unique_ptr<LeafModel> clone() const = 0;

    /// The metrics at `x`. leaves[i] holds x[i], or the point of the domain that is nearest to it,
    /// whose metric it is then. Called with some hundred places at most.
    virtual void values(const Topology<Node>& tree, std::span<const LeafIndex> leaves,
                        std::span<const Point> x, std::span<Metric> out) const = 0;
    /// The same as lengths, where all metrics are isotropic.
    virtual void lengths(const Topology<Node>& tree, std::span<const LeafIndex> leaves,
                         std::span<const Point> x, std::span<double> out) const;
    /// What the sources alone request at x, before gradation: what insertion compares with.
    virtual Metric requested(const Topology<Node>& tree, LeafIndex leaf, const Point& x) const;
    /// Upper bounds of the requested isotropic lengths at `x`, now and after all later insertions
    /// of isotropic sources; infinity where there is none.
    virtual void ceilings(const Topology<Node>& tree, std::span<const LeafIndex> leaves,
                          std::span<const Point> x, std::span<double> out) const;
    /// Starts anew with the leaves of a tree, each of which requests a metric
    /// (ModelTraits::Insertion::collected).
    virtual void collect(const Topology<Node>& /*tree*/, std::span<const Metric> /*requests*/) {}
    /// Makes queries faster until a leaf is cut; they may come without it.
    virtual void prepare(const Topology<Node>& /*tree*/) {}
    /// A cursor for lengths, where all metrics are isotropic; null where it would remember nothing.
    virtual std::unique_ptr<Cursor> cursor(const Topology<Node>& /*tree*/) const { return nullptr; }

    /// The compact form: it is only read, and leaves are numbered depth first.
    virtual std::unique_ptr<ControlSpace> compact(const Topology<Node>& tree,
                                                  Precision precision) const = 0;
    /// Checks what was loaded for a tree, and makes what is not in files. Throws InputError.
    virtual void loaded(const Topology<Node>& tree, const StateReader& state);

protected:
    LeafModel(const ModelTraits& traits, NodeMetrics metrics)
        : CellModel(traits, std::move(metrics)) {}
};

extern template class LeafModel<KdNode>;
extern template class LeafModel<OctreeNode>;

}  // namespace controlspace
