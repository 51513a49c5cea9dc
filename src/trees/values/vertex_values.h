// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <memory>
#include <span>
#include <vector>

#include "controlspace/trees/leaf_model.h"
#include "trees/topology/place_index.h"

namespace controlspace {

/// A metric at each vertex of the leaves, trilinear between the eight of a leaf (K_V, K_oV).
///
/// A vertex is one control node for all leaves that have a corner there, hanging vertices included.
/// A new vertex of a split gets the interpolated metric; where a control node stands already, it is
/// intersected with that. So a split changes the field only where it makes a finer neighbour's
/// vertex count, and never makes it larger. Or else vertices collect what the leaves around them
/// request, when these have grown (SpaceOptions::vertices_in_turn).
template <class Node>
class VertexValues final : public LeafModel<Node> {
public:
    static constexpr ModelTraits model_traits{.order = 1,
                                              .cut_by = CutBy::edges,
                                              .has_lengths = true,
                                              .is_trilinear = true,
                                              .insertion = ModelTraits::Insertion::collected};

    explicit VertexValues(const SpaceOptions& options);

    std::unique_ptr<LeafModel<Node>> clone() const override {
        return std::make_unique<VertexValues>(*this);
    }
    std::span<const Corners> corners() const override { return corners_; }
    std::span<const Point> positions() const override { return positions_; }

    void values(const Topology<Node>& tree, std::span<const LeafIndex> leaves,
                std::span<const Point> x, std::span<Metric> out) const override;
    void lengths(const Topology<Node>& tree, std::span<const LeafIndex> leaves,
                 std::span<const Point> x, std::span<double> out) const override;
    std::unique_ptr<Cursor> cursor(const Topology<Node>& tree) const override;
    std::unique_ptr<ControlSpace> compact(const Topology<Node>& tree,
                                          Precision precision) const override;

    void split(const Subdivision& subdivision, LeafIndex leaf, LeafIndex first_new) override;
    void collect(const Topology<Node>& tree, std::span<const Metric> requests) override;

    /// Isotropic lengths are proven to follow a field that has bounds, or not to.
    bool has_bounds(const GoalField& field) const override;
    Judgement judge(const CellBox& leaf, CellJudge& judge) const override;

    void arrays(LeafArrays& visitor) override { visitor("vertices.of_leaves", corners_); }
    /// Checks the vertices, and finds their positions.
    void loaded(const Topology<Node>& tree, const StateReader& state) override;
    void describe(Footprint& footprint) const override;
    void shrink_to_fit() override;

private:
    struct Field;
    void prefetch(std::span<const LeafIndex> leaves) const;
    NodeIndex vertex_at(const Point& x, const Box& box, const Corners& corners);

    std::vector<Corners> corners_;  // of a leaf
    std::vector<Point> positions_;
    PlaceIndex places_;
};

extern template class VertexValues<KdNode>;
extern template class VertexValues<OctreeNode>;

}  // namespace controlspace
