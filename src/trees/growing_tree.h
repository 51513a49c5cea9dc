// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "controlspace/space/adaptation.h"
#include "controlspace/space/space_options.h"
#include "controlspace/trees/leaf_model.h"
#include "controlspace/trees/tree_row.h"
#include "trees/insertion/source_cuts.h"
#include "trees/topology/topology.h"

namespace controlspace {

class GoalField;

[[noreturn]] void fail_too_many_leaves();
[[noreturn]] void fail_too_large(std::size_t bytes, std::size_t max_bytes);
/// AdaptationReport::shortfall where leaves of a level are not cut, which no depth may exceed if it
/// is the `deepest`.
std::string depth_shortfall(int max_depth, int deepest);
/// The same where a field is too steep for leaves as short as an element.
std::string steepness_shortfall();
[[noreturn]] void fail_stopped(GrowthStop stop, std::size_t leaves);

/// A model that is copied with the tree that holds it.
template <class Node>
class OwnModel {
public:
    explicit OwnModel(std::unique_ptr<LeafModel<Node>> model) : model_(std::move(model)) {}
    OwnModel(const OwnModel& other) : model_(other.model_->clone()) {}
    OwnModel& operator=(std::unique_ptr<LeafModel<Node>> model) {
        model_ = std::move(model);
        return *this;
    }

    LeafModel<Node>& operator*() { return *model_; }
    const LeafModel<Node>& operator*() const { return *model_; }
    LeafModel<Node>* operator->() { return model_.get(); }
    const LeafModel<Node>* operator->() const { return model_.get(); }

private:
    std::unique_ptr<LeafModel<Node>> model_;
};

/// A tree over a box whose leaves are cut, for sources or to follow a field: what MetricTree and
/// SourceTree share. `Node` is how a box is cut, the model what leaves hold.
template <class Node>
class GrowingTree {
public:
    void sample(std::span<const Point> x, std::span<Metric> out) const;
    Metric metric_at(const Point& x) const;
    const Box& domain() const { return topology_.domain(); }
    const SpaceOptions& options() const { return options_; }
    Box cell_at(const Point& x) const { return topology_.locate(x).box; }
    Footprint footprint() const;
    /// Of interpolation.
    int order() const { return model_->traits().order; }
    const LeafModel<Node>& model() const { return *model_; }

    bool is_finished() const { return is_finished_; }

protected:
    /// With `balanced`, no leaf has a neighbour across a face that is more than one level coarser
    /// (octrees).
    GrowingTree(const SpaceOptions& options, MakeLeafModel<Node> make_model, bool balanced);

    SourceCuts<Node> cuts() const { return SourceCuts<Node>(options_, deepest_); }

    /// Empties the tree and cuts it until it follows the field; `begin` may prepare the model.
    AdaptationReport adapt(const AdaptationGoal& goal, const std::function<void()>& begin);

    using CutLeaf = std::function<bool(const CellBox&, const std::array<double, 3>& along,
                                       std::vector<LeafIndex>& cut)>;
    struct Adapted {
        double reached;  ///< as of Adaptation::run
        bool is_late, is_bound;
    };
    /// Cuts the leaves that there are until they follow the field (Adaptation).
    Adapted follow(const GoalField& field, const AdaptationGoal& goal, const GrowthLimit& limit,
                   bool is_searched, const CutLeaf& cut);

    /// Cuts the leaf that holds the source until it is short enough. Returns its place.
    LeafPlace cut_for(const PointSource& source);

    /// The deepest level of leaves that are cut for anything but a source.
    int max_depth() const;

    /// Cuts the leaf with this box where something varies by `along` the axes, unless it is among
    /// the smallest allowed.
    bool split_across(const Box& box, const std::array<double, 3>& along,
                      std::vector<LeafIndex>& cut);

    /// Appends to `cut`, if given, the leaf and all others that had to be split before it or with
    /// it.
    void split(const LeafPlace& place, const Subdivision& subdivision, std::vector<LeafIndex>* cut);

    /// Splits leaves until none has a neighbour across a face that is more than one level coarser:
    /// the least such tree, whatever the order.
    void balance();

    /// Splits leaves until those of each brick are of one level: the least such tree. Only the
    /// topology is changed; repeat(leaf, times) copies what else there is for a leaf.
    void complete_bricks(const std::function<void(LeafIndex, std::size_t)>& repeat);

    /// Throws InputError where the tree is not to have so many leaves more.
    void make_room_for(std::size_t more);
    /// Throws GrowthStopped at a limit of time or memory.
    void require_may_grow() const;
    /// Stops a tree of so many leaves that outgrows the cap, long before the system stops the
    /// program.
    void require_memory(std::size_t leaves);
    /// The same of gradation from node to node, which copies the nodes and links them.
    void require_memory_to_grade(Neighbourhood neighbourhood) const;

    /// Gives back what only growing needs, and makes what only answers need.
    void settle();

    /// Whether the box is far shorter than an element, and the field of this ratio varies little in
    /// it.
    bool is_negligible(const Box& box, double ratio) const;

    SpaceOptions options_;
    int deepest_ = deepest_level<Node>;  // of what the model or a finished form can hold
    bool balanced_;
    /// If positive, leaves are cut together with all that have the same ancestor so many levels
    /// above: they make bricks of (2^levels)^3 leaves of one size. The first levels are cut all
    /// over.
    int brick_levels_ = 0;
    MakeLeafModel<Node> make_model_;
    Topology<Node> topology_;
    OwnModel<Node> model_;
    bool is_finished_ = false;       // nothing has grown since `settle`
    std::size_t bytes_to_come_ = 0;  // for each leaf, beside what it takes already
    std::size_t bytes_aside_ = 0;    // of what is to be entered into the tree

private:
    void split_alone(const LeafPlace& place, const Subdivision& subdivision,
                     std::vector<LeafIndex>* cut);
    void split_brick(const LeafPlace& place, std::vector<LeafIndex>* cut);
    std::size_t more_by_brick() const;
    GrowthStop growth_stop() const;
    void require_bytes(std::size_t bytes) const;
    void list_inner(const TreePart& part, int level, std::vector<LeafPlace>& inner) const;
    void refine_coarser_neighbours(const LeafPlace& place, std::vector<LeafIndex>* cut);

    std::size_t next_check_ = 0;  // number of leaves at which memory is checked again
    bool outgrows_ = false;       // its limit of memory, when it was checked last
    bool is_adapted_ = false;     // at this moment
};

extern template class GrowingTree<KdNode>;
extern template class GrowingTree<OctreeNode>;

}  // namespace controlspace
