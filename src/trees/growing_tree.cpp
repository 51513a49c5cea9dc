// SPDX-License-Identifier: Apache-2.0
#include "trees/growing_tree.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "controlspace/input_errors.h"
#include "refuse.h"
#include "space/goal_field.h"
#include "trees/adaptation/adaptation.h"
#include "trees/sample_leaves.h"
#include "trees/topology/adjacency.h"

namespace controlspace {

void fail_too_many_leaves() {
    throw InputError("a tree holds 2^30 leaves at most: raise l_min or lower the depth");
}

void fail_too_large(std::size_t bytes, std::size_t max_bytes) {
    constexpr double gib = 1024.0 * 1024 * 1024;
    throw MemoryLimitError(
        bytes,
        fmt::format("the tree would take more than {:.3g} GiB, gradation included: raise tau "
                    "(l_min) or target_delta, or max_memory",
                    static_cast<double>(max_bytes) / gib));
}

std::string depth_shortfall(int max_depth, int deepest) {
    return fmt::format("leaves of level {} are not cut{}", max_depth,
                       max_depth < deepest
                           ? ": raise the depth, or target_delta (within)"
                           : ", the deepest of this structure: raise target_delta (within)");
}

std::string steepness_shortfall() {
    return "the field is steep: leaves far shorter than an element are not cut: raise "
           "target_delta";
}

namespace {

// AdaptationReport::shortfall where there are as many leaves as allowed.
std::string leaves_shortfall(std::size_t max_leaves) {
    return fmt::format("more than {} leaves are needed: raise max_leaves (0: no limit)",
                       max_leaves);
}

// The same at a limit of time or memory.
std::string limit_shortfall(GrowthStop stop) {
    return stop == GrowthStop::time ? "no time was left" : "no memory was left";
}

// What adaptation sees of a tree.
template <class Node>
class TreeCells final : public AdaptedCells {
public:
    TreeCells(const Topology<Node>& tree, LeafModel<Node>& model) : tree_(tree), model_(model) {}

    Box domain() const override { return tree_.domain(); }
    std::size_t count() const override { return tree_.leaves(); }
    std::size_t most_parts() const override { return Node::arity; }
    std::vector<CellBox> where(const std::function<bool(CellIndex)>& is_wanted) const override {
        std::vector<CellBox> leaves;
        tree_.for_each_leaf([&](LeafIndex leaf, const Box& box) {
            if (is_wanted(leaf)) leaves.push_back({leaf, box});
        });
        return leaves;
    }
    CellBox at(const Point& x) const override { return tree_.locate(x).cell(); }
    CellIndex number_at(const Point& x) const override { return tree_.find(x); }
    void values(CellIndex cell, std::span<const Point> x, std::span<Metric> out) const override {
        std::array<LeafIndex, most_values> leaves;
        const auto all = std::span(leaves).first(x.size());
        std::ranges::fill(all, cell);
        model_.values(tree_, all, x, out);
    }
    CellModel& model() override { return model_; }
    const CellModel& model() const override { return model_; }

private:
    const Topology<Node>& tree_;
    LeafModel<Node>& model_;
};

}  // namespace

void fail_stopped(GrowthStop stop, std::size_t leaves) {
    throw GrowthStopped(
        stop, leaves,
        fmt::format("the tree is not finished: {} with {} leaves", limit_shortfall(stop), leaves));
}

template <class Node>
GrowingTree<Node>::GrowingTree(const SpaceOptions& options, MakeLeafModel<Node> make_model,
                               bool balanced)
    : options_(options),
      balanced_(balanced),
      make_model_(make_model),
      topology_(options.domain),
      model_(make_model(options)) {}

template <class Node>
void GrowingTree<Node>::sample(std::span<const Point> x, std::span<Metric> out) const {
    sample_leaves(
        topology_, x, out,
        [&](std::span<const LeafIndex> leaves, std::span<const Point> part,
            std::span<Metric> values) { model_->values(topology_, leaves, part, values); });
}

template <class Node>
Metric GrowingTree<Node>::metric_at(const Point& x) const {
    return value_at(topology_, *model_, x);
}

template <class Node>
Footprint GrowingTree<Node>::footprint() const {
    Footprint footprint;
    topology_.describe(footprint);
    model_->describe(footprint);
    return footprint;
}

template <class Node>
typename GrowingTree<Node>::Adapted GrowingTree<Node>::follow(const GoalField& field,
                                                              const AdaptationGoal& goal,
                                                              const GrowthLimit& limit,
                                                              bool is_searched,
                                                              const CutLeaf& cut) {
    TreeCells<Node> cells(topology_, *model_);
    Adaptation adaptation(cells, field, goal, limit);
    const double reached = adaptation.run(is_searched, cut);
    return {reached, adaptation.is_late(), adaptation.shows_bounds()};
}

template <class Node>
AdaptationReport GrowingTree<Node>::adapt(const AdaptationGoal& goal,
                                          const std::function<void()>& begin) {
    constexpr std::size_t bytes_of_adaptation = 240;  // for each leaf
    AdaptationGoal of_field = goal;
    if (model_->traits().is_trilinear) of_field.values = NodeValues::field;
    const GoalField field(of_field, domain(), GoalField::many_answers,
                          GoalField::Thinning::allowed);
    if (goal.values == NodeValues::fitted && !model_->has_bounds(field)) {
        refuse(
            "values are fitted to lengths alone, of sources without a continuous field: give "
            "values "
            "`field`");
    }
    bytes_to_come_ = bytes_of_adaptation;
    next_check_ = 0;
    is_adapted_ = true;
    outgrows_ = false;
    topology_ = Topology<Node>(domain());
    model_ = make_model_(options_);
    begin();
    AdaptationReport report;
    bool too_deep = false;
    bool too_short = false;
    GrowthStop stop = GrowthStop::none;
    const Adapted adapted = follow(
        field, goal, options_.growth, true,
        [&](const CellBox& leaf, const std::array<double, 3>& along, std::vector<LeafIndex>& cut) {
            const bool is_full = topology_.leaves() + more_by_brick() >= goal.max_leaves;
            stop = is_full ? GrowthStop::leaves : growth_stop();
            if (stop != GrowthStop::none) return false;
            if (is_negligible(leaf.box, field.largest_ratio())) {
                too_short = true;
                return false;
            }
            const bool done = split_across(leaf.box, along, cut);
            too_deep = too_deep || !done;
            return done;
        });
    report.reached = adapted.reached;
    bytes_to_come_ = 0;
    is_adapted_ = false;
    if (adapted.is_late) stop = GrowthStop::time;
    report.met = report.reached <= field.target();
    report.reached = field.departure_from_all(report.reached);
    report.is_bound = report.met && adapted.is_bound;
    if (report.met) {
        // Leaves that were not cut may be just below the target.
    } else if (stop != GrowthStop::none) {
        report.stop = stop;
        report.shortfall =
            stop == GrowthStop::leaves ? leaves_shortfall(goal.max_leaves) : limit_shortfall(stop);
    } else if (too_deep) {
        report.shortfall = depth_shortfall(max_depth(), deepest_);
    } else if (too_short) {
        report.shortfall = steepness_shortfall();
    }
    return report;
}

template <class Node>
LeafPlace GrowingTree<Node>::cut_for(const PointSource& source) {
    LeafPlace place = topology_.locate(source.position);
    while (const auto cut = cuts().cut(place, source)) {
        split(place, *cut, nullptr);
        place = topology_.locate_from(place, source.position);
    }
    return place;
}

template <class Node>
int GrowingTree<Node>::max_depth() const {
    const auto& depth = Node::is_octant ? options_.octree_depth : options_.kd_depth;
    return std::min(depth.value_or(deepest_), deepest_);
}

template <class Node>
bool GrowingTree<Node>::split_across(const Box& box, const std::array<double, 3>& along,
                                     std::vector<LeafIndex>& cut) {
    const LeafPlace place = topology_.locate(box.centre());
    const Subdivision subdivision =
        Node::subdivision_across(domain(), place.level, place.box, along);
    if (place.level >= max_depth() || !subdivision.is_proper()) return false;
    split(place, subdivision, &cut);
    return true;
}

template <class Node>
void GrowingTree<Node>::split(const LeafPlace& place, const Subdivision& subdivision,
                              std::vector<LeafIndex>* cut) {
    if (brick_levels_ > 0) return split_brick(place, cut);
    make_room_for(Node::arity - 1);
    if (balanced_) refine_coarser_neighbours(place, cut);
    split_alone(place, subdivision, cut);
}

template <class Node>
void GrowingTree<Node>::balance() {
    std::vector<LeafPlace> inner;
    list_inner({topology_.root(), domain()}, 0, inner);
    for (const LeafPlace& place : inner) refine_coarser_neighbours(place, nullptr);
}

template <class Node>
void GrowingTree<Node>::complete_bricks(const std::function<void(LeafIndex, std::size_t)>& repeat) {
    const std::vector<std::uint8_t> levels = topology_.levels_below();
    struct Coarse {
        Point inside;
        int level;  // that it, or its parts, are to have
    };
    std::vector<Coarse> coarse;
    const auto list = [&](const auto& self, const TreePart& part, int level) -> void {
        const int below = part.ref.is_leaf() ? 0 : levels[part.ref.index()];
        if (below > brick_levels_) {
            topology_.for_each_child(part,
                                     [&](const TreePart& child) { self(self, child, level + 1); });
            return;
        }
        // The domain itself may be a brick of fewer levels.
        const int least = level == 0 ? below : level + brick_levels_;
        topology_.for_each_leaf_in(part, [&](LeafIndex, const Box& box) {
            coarse.push_back({box.centre(), least});
        });
    };
    list(list, {topology_.root(), domain()}, 0);
    const auto deepen = [&](const auto& self, const Point& inside, int least) -> void {
        const LeafPlace place = topology_.locate(inside);
        const Subdivision parts = Node::even_subdivision(domain(), place.level, place.box);
        if (place.level >= least || !parts.is_proper()) return;
        make_room_for(Node::arity - 1);
        topology_.split(place, parts);
        topology_.fit_jumps_roughly();
        repeat(place.leaf, static_cast<std::size_t>(parts.children() - 1));
        for (int c = 0; c < parts.children(); ++c) self(self, parts.child(c).centre(), least);
    };
    for (const Coarse& leaf : coarse) deepen(deepen, leaf.inside, leaf.level);
}

template <class Node>
void GrowingTree<Node>::make_room_for(std::size_t more) {
    if (topology_.is_full(more)) fail_too_many_leaves();
    const std::size_t leaves = topology_.leaves() + more;
    if (leaves <= next_check_) return;
    require_memory(leaves);
    // Adaptation ends between leaves.
    if (!is_adapted_) require_may_grow();
}

template <class Node>
void GrowingTree<Node>::require_may_grow() const {
    const GrowthStop stop = growth_stop();
    if (stop != GrowthStop::none) fail_stopped(stop, topology_.leaves());
}

template <class Node>
void GrowingTree<Node>::require_memory(std::size_t leaves) {
    // While an array grows, and while the finished tree is compared and packed.
    constexpr std::size_t bytes_beside = 64;
    const std::size_t bytes = footprint().bytes_total();
    require_bytes(bytes + std::min(bytes, most_bytes_twice) + bytes_aside_ +
                  leaves * (bytes_beside + bytes_to_come_));
    outgrows_ = bytes > options_.growth.bytes;
    next_check_ = leaves + leaves / 16;
}

template <class Node>
void GrowingTree<Node>::require_memory_to_grade(Neighbourhood neighbourhood) const {
    // Over faces 145 bytes for a leaf, 290 for its vertices; with all neighbours up to 640.
    const std::size_t bytes_per_leaf = neighbourhood == Neighbourhood::all ? 700 : 300;
    require_bytes(footprint().bytes_total() + topology_.leaves() * bytes_per_leaf);
}

template <class Node>
void GrowingTree<Node>::settle() {
    topology_.shrink_to_fit();
    topology_.fit_jumps();
    model_->shrink_to_fit();
    model_->prepare(topology_);
    is_finished_ = true;
}

template <class Node>
bool GrowingTree<Node>::is_negligible(const Box& box, double ratio) const {
    // Fields may be steep: the intersection of tensors in turn depends on which is the smallest.
    constexpr double usual_slope = 0.25;
    const double share_of_element = 1.0 / 16 * (usual_slope / std::max(usual_slope, ratio - 1));
    const Metric m = value_at(topology_, *model_, box.centre());
    const auto lengths = metric_edge_lengths(m, box.edges());
    return std::max({lengths[0], lengths[1], lengths[2]}) < share_of_element;
}

template <class Node>
void GrowingTree<Node>::split_alone(const LeafPlace& place, const Subdivision& subdivision,
                                    std::vector<LeafIndex>* cut) {
    const auto first_new = static_cast<LeafIndex>(topology_.leaves());
    topology_.split(place, subdivision);
    topology_.fit_jumps_roughly();
    model_->split(subdivision, place.leaf, first_new);
    if (cut != nullptr) cut->push_back(place.leaf);
}

template <class Node>
void GrowingTree<Node>::split_brick(const LeafPlace& place, std::vector<LeafIndex>* cut) {
    TreePart brick{topology_.root(), domain()};
    for (int level = 0; level + brick_levels_ < place.level; ++level) {
        const std::size_t slot = topology_.node(brick.ref).descend(place.box.centre(), brick.box);
        brick.ref = topology_.node(brick.ref).children[slot];
    }
    std::vector<Point> inside;
    topology_.for_each_leaf_in(brick,
                               [&](LeafIndex, const Box& box) { inside.push_back(box.centre()); });
    make_room_for(inside.size() * (Node::arity - 1));
    for (const Point& x : inside) {
        const LeafPlace leaf = topology_.locate(x);
        const Subdivision parts = Node::even_subdivision(domain(), leaf.level, leaf.box);
        if (parts.is_proper()) split_alone(leaf, parts, cut);
    }
}

template <class Node>
std::size_t GrowingTree<Node>::more_by_brick() const {
    const std::size_t of_brick = std::size_t{1} << 3 * brick_levels_;
    return (std::min(of_brick, topology_.leaves()) - 1) * (Node::arity - 1);
}

template <class Node>
GrowthStop GrowingTree<Node>::growth_stop() const {
    if (outgrows_) return GrowthStop::memory;
    return options_.growth.is_late() ? GrowthStop::time : GrowthStop::none;
}

template <class Node>
void GrowingTree<Node>::require_bytes(std::size_t bytes) const {
    if (bytes > options_.max_bytes) fail_too_large(bytes, options_.max_bytes);
}

template <class Node>
void GrowingTree<Node>::list_inner(const TreePart& part, int level,
                                   std::vector<LeafPlace>& inner) const {
    if (part.ref.is_leaf()) return;
    LeafPlace& place = inner.emplace_back();
    place.box = part.box;
    place.level = level;
    topology_.for_each_child(part,
                             [&](const TreePart& child) { list_inner(child, level + 1, inner); });
}

template <class Node>
void GrowingTree<Node>::refine_coarser_neighbours(const LeafPlace& place,
                                                  std::vector<LeafIndex>* cut) {
    for (int face = 0; face < 6; ++face) {
        LeafPlace neighbour;
        while (locate_across(topology_, place.box, face, place.box.centre(), neighbour) &&
               neighbour.level < place.level) {
            split(neighbour, Node::even_subdivision(domain(), neighbour.level, neighbour.box), cut);
        }
    }
}

template class GrowingTree<KdNode>;
template class GrowingTree<OctreeNode>;

}  // namespace controlspace
