// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "controlspace/trees/leaf_metrics.h"

namespace controlspace {

/// One metric a leaf, constant over it (K_L, K_oL, K_oLB).
template <class Node>
class ConstantValues final : public LeafMetrics<Node> {
public:
    static constexpr ModelTraits model_traits{.order = 0,
                                              .cut_by = CutBy::corners,
                                              .has_lengths = true,
                                              .insertion = ModelTraits::Insertion::by_leaf};

    explicit ConstantValues(const SpaceOptions& options)
        : LeafMetrics<Node>(options, model_traits) {}

    std::unique_ptr<LeafModel<Node>> clone() const override {
        return std::make_unique<ConstantValues>(*this);
    }
    void vary(std::span<const LeafIndex>, std::span<const Point>,
              std::span<Metric>) const override {}
    void values(const Topology<Node>& tree, std::span<const LeafIndex> leaves,
                std::span<const Point> x, std::span<Metric> out) const override;
    void lengths(const Topology<Node>& tree, std::span<const LeafIndex> leaves,
                 std::span<const Point> x, std::span<double> out) const override;
    std::unique_ptr<ControlSpace> compact(const Topology<Node>& tree,
                                          Precision precision) const override;

    /// The middle between the bounds of the field in each leaf, where it has some: nothing is
    /// sampled then. Otherwise the field at its centre.
    std::vector<Judgement> fit(std::span<const CellBox> leaves, const FieldToFit& to) override;
    bool has_bounds(const GoalField& field) const override;
};

extern template class ConstantValues<KdNode>;
extern template class ConstantValues<OctreeNode>;

}  // namespace controlspace
