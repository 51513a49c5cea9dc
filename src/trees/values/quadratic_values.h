// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "controlspace/trees/leaf_metrics.h"
#include "trees/topology/parts_across.h"

namespace controlspace {

/// One metric a leaf, interpolated with those of its face neighbours (K_Li, K_oLi; paper §3.1.2).
/// Nowhere coarser than the cone of the leaf's own metric at its centre, with the ratio of the last
/// gradation, or of the one to come: on the paper's sphere that leaves its Tables 1 and 4 as they
/// are, and divides δ_S by up to 20.
template <class Node>
class QuadraticValues final : public LeafMetrics<Node> {
    using Base = LeafMetrics<Node>;

public:
    static constexpr ModelTraits model_traits{
        .order = 2, .cut_by = CutBy::faces, .follows_neighbours = true, .has_lengths = true};

    explicit QuadraticValues(const SpaceOptions& options);

    std::unique_ptr<LeafModel<Node>> clone() const override {
        return std::make_unique<QuadraticValues>(*this);
    }
    void vary(std::span<const LeafIndex>, std::span<const Point>,
              std::span<Metric>) const override {}
    void values(const Topology<Node>& tree, std::span<const LeafIndex> leaves,
                std::span<const Point> x, std::span<Metric> out) const override;
    void lengths(const Topology<Node>& tree, std::span<const LeafIndex> leaves,
                 std::span<const Point> x, std::span<double> out) const override;
    Metric requested(const Topology<Node>& tree, LeafIndex leaf, const Point& x) const override;
    void ceilings(const Topology<Node>& tree, std::span<const LeafIndex> leaves,
                  std::span<const Point> x, std::span<double> out) const override;
    std::unique_ptr<ControlSpace> compact(const Topology<Node>& tree,
                                          Precision precision) const override;

    void split(const Subdivision& subdivision, LeafIndex leaf, LeafIndex first_new) override;
    void lower(const CellBox& leaf, const Metric& metric) override;
    void assigned() override;
    void graded(double ratio) override;
    void prepare(const Topology<Node>& tree) override;

    void arrays(LeafArrays& visitor) override { visitor("quadratic.slope", slope_); }
    void loaded(const Topology<Node>& tree, const StateReader& state) override;
    void describe(Footprint& footprint) const override;
    void shrink_to_fit() override;

private:
    struct Values;
    template <class Value>
    void interpolate(const Topology<Node>& tree, std::span<const LeafIndex> leaves,
                     std::span<const Point> x, double slope, std::span<Value> out) const;
    void prefetch(std::span<const LeafIndex> leaves) const;

    std::vector<Box> boxes_;           // of the leaves
    std::vector<PartsAcross> across_;  // of the leaves; empty where they are not known
    // g_r - 1: of the field before gradation, which insertion compares with, and of the graded one.
    double requested_slope_, slope_;
    QuadraticForm form_;
    bool isotropic_ = true;  // all metrics are; false where that is not known
};

extern template class QuadraticValues<KdNode>;
extern template class QuadraticValues<OctreeNode>;

}  // namespace controlspace
