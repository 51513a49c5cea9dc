#pragma once

#include <memory>
#include <span>
#include <vector>

#include "controlspace/space/adaptation.h"
#include "controlspace/space/detail/shared_builder.h"
#include "controlspace/trees/detail/metric_tree.h"

namespace controlspace {

/// An octree that is exact in some of the octants which it is cut into beforehand: what is cut in
/// an octant depends on nothing outside of it but the field.
template <class Storage>
class RankTree : public MetricTree<OctreeNode, Storage> {
    using Growing = GrowingTree<OctreeNode, Storage>;

public:
    /// `octants` are some leaves of an octree over the same domain.
    RankTree(const SpaceOptions& options, std::span<const Box> octants)
        : MetricTree<OctreeNode, Storage>(options), octants_(octants.begin(), octants.end()) {
        cut_to_octants();
    }

    /// As MetricTree's, from the octants on.
    AdaptationReport adapt(const AdaptationGoal& goal) {
        const AdaptationReport report = Growing::adapt(goal, [&] { cut_to_octants(); });
        this->finish();
        return report;
    }

private:
    void cut_to_octants() {
        std::vector<LeafIndex> cut;
        for (const Box& octant : octants_) {
            for (Box cell; (cell = this->cell_at(octant.centre())) != octant;) {
                Growing::split_across(cell, {}, cut);
            }
        }
    }

    std::vector<Box> octants_;
};

}  // namespace controlspace
