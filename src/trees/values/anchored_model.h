// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "controlspace/trees/leaf_model.h"
#include "trees/values/anchored_values.h"

namespace controlspace {

/// Leaves that keep sources (K_LA, K_oLA), as a model: AnchoredValues does what is to be done. It
/// has no nodes; a SourceTree inserts, grades and saves.
template <class Node>
class AnchoredModel final : public LeafModel<Node> {
public:
    static constexpr ModelTraits model_traits{.order = 0, .cut_by = CutBy::longest_edge};

    explicit AnchoredModel(const SpaceOptions& options)
        : LeafModel<Node>(model_traits, NodeMetrics(0, Metric())), anchored_(options) {}

    AnchoredValues& anchored() { return anchored_; }
    const AnchoredValues& anchored() const { return anchored_; }

    std::unique_ptr<LeafModel<Node>> clone() const override {
        return std::make_unique<AnchoredModel>(*this);
    }
    void values(const Topology<Node>& tree, std::span<const LeafIndex> leaves,
                std::span<const Point> x, std::span<Metric> out) const override;
    void split(const Subdivision& subdivision, LeafIndex leaf, LeafIndex) override {
        anchored_.split(subdivision, leaf);
    }
    /// It has none.
    std::unique_ptr<ControlSpace> compact(const Topology<Node>& tree,
                                          Precision precision) const override;

    /// A field that has bounds is covered everywhere, where leaves are to be searched; otherwise
    /// leaves get anchors for their places.
    std::vector<Judgement> fit(std::span<const CellBox> leaves, const FieldToFit& to) override;
    bool has_bounds(const GoalField& field) const override;
    bool is_fitted(LeafIndex leaf) const override { return anchored_.is_fitted(leaf); }
    bool improves() const override { return true; }
    std::vector<std::uint32_t> improvement(LeafIndex leaf, const Point& x, NearbyField& nearby,
                                           const GoalField& field) const override {
        return anchored_.lacking(leaf, x, nearby, field);
    }
    void improve(LeafIndex leaf, std::span<const std::uint32_t> improvement) override {
        anchored_.set(leaf, improvement);
    }

    void describe(Footprint& footprint) const override { anchored_.describe(footprint); }
    void shrink_to_fit() override { anchored_.shrink_to_fit(); }

private:
    AnchoredValues anchored_;
};

extern template class AnchoredModel<KdNode>;
extern template class AnchoredModel<OctreeNode>;

}  // namespace controlspace
