// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <span>

#include "controlspace/space/control_nodes.h"
#include "controlspace/space/control_space_builder.h"
#include "trees/growing_tree.h"
#include "trees/values/anchored_model.h"

namespace controlspace {

/// A tree whose leaves keep sources (K_LA, K_oLA), for SharedBuilder: a query evaluates the
/// cones of the leaf's sources.
template <class Node>
class SourceTree : public GrowingTree<Node> {
    using Base = GrowingTree<Node>;
    using Base::is_finished_, Base::options_, Base::topology_;

public:
    explicit SourceTree(const SpaceOptions& options);

    /// Without the calls by which a model of any kind answers.
    Metric metric_at(const Point& x) const {
        return anchored().value(Base::domain(), topology_.find(x), x);
    }

    InsertionReport insert(std::span<const PointSource> sources);

    /// Leaf centres with the field there.
    ControlNodes control_nodes(Neighbourhood neighbourhood) const;

    /// Finds the sources that govern the leaves; the law is always the cone law. Leaves that a few
    /// sources do not bring near to the field are cut, down to l_min in their own metric; where
    /// there are 64 tensors at most, none is, for it may have all of them. The field gets nowhere
    /// longer, if all is isotropic: a ratio larger than before changes nothing, and what may govern
    /// a place in a leaf stays its anchor. Without new sources or a smaller ratio there is nothing
    /// to do.
    GradationReport grade(const GradationOptions& options);

    AdaptationReport adapt(const AdaptationGoal& goal);
    void finish();
    void save(StateWriter& state) const;
    void load(const StateReader& state);

private:
    AnchoredValues& anchored() {
        return static_cast<AnchoredModel<Node>&>(*Base::model_).anchored();
    }
    const AnchoredValues& anchored() const {
        return static_cast<const AnchoredModel<Node>&>(*Base::model_).anchored();
    }
    Metric held_at(const Point& x, LongLists& long_lists) const;
    double ratio_left() const;

    bool is_graded_ = false;  // no source has come since
};

extern template class SourceTree<KdNode>;
extern template class SourceTree<OctreeNode>;

/// A builder of such a tree.
template <class Node>
std::unique_ptr<ControlSpaceBuilder> make_source_tree(const SpaceOptions& options);

}  // namespace controlspace
