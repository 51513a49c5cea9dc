// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <span>

#include "controlspace/space/space_options.h"
#include "controlspace/trees/leaf_model.h"

namespace controlspace {

/// One metric a leaf, at its centre: a base for models that vary it in the leaf. Of these only
/// `clone` and `vary` must be written; `split`, `lower`, `assigned`, `fit` and `arrays` where they
/// hold more than the metric.
template <class Node>
class LeafMetrics : public LeafModel<Node> {
public:
    void split(const Subdivision& subdivision, LeafIndex leaf, LeafIndex first_new) override;
    /// The metric of the leaf, as `vary` changes it.
    void values(const Topology<Node>& tree, std::span<const LeafIndex> leaves,
                std::span<const Point> x, std::span<Metric> out) const override;
    std::unique_ptr<ControlSpace> compact(const Topology<Node>& tree,
                                          Precision precision) const override;

    /// Makes the metrics of leaves, of which each `metrics[i]` is the one of leaves[i], those at
    /// x[i]; of a point outside of the domain that of the nearest one inside.
    virtual void vary(std::span<const LeafIndex> leaves, std::span<const Point> x,
                      std::span<Metric> metrics) const = 0;

protected:
    LeafMetrics(const SpaceOptions& options, const ModelTraits& traits)
        : LeafModel<Node>(traits, NodeMetrics(1, largest_metric(options))) {}
};

extern template class LeafMetrics<KdNode>;
extern template class LeafMetrics<OctreeNode>;

}  // namespace controlspace
