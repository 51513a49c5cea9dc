#include "trees/regradation/leaf_changes.h"

namespace controlspace {

void LeafChanges::begin(std::size_t leaves, std::size_t) {
    cut_.begin(leaves);
    cuts_.clear();
    lowered_.clear();
}

// A leaf that has been lowered before it is cut held its neighbours down with more than `held`:
// that may put more of them in doubt than need be, never fewer.
void LeafChanges::cut(const Box& box, LeafIndex leaf, double held) {
    if (!cut_.is_old(leaf)) return;
    cut_.enter(leaf);
    cuts_.push_back({box, held});
}

void LeafChanges::save(StateWriter& state) const {
    CutLeaves::exchange(cut_, state);
    std::vector<Box> boxes;
    std::vector<double> held;
    for (const Cut& cut : cuts_) {
        boxes.push_back(cut.box);
        held.push_back(cut.held);
    }
    state("changes.cut_boxes", boxes);
    state("changes.cut_held", held);
    boxes.clear();
    std::vector<LeafIndex> leaves;
    for (const Leaf& leaf : lowered_) {
        boxes.push_back(leaf.box);
        leaves.push_back(leaf.leaf);
    }
    state("changes.lowered", leaves);
    state("changes.lowered_boxes", boxes);
}

void LeafChanges::load(const StateReader& state, std::size_t leaves, std::size_t) {
    CutLeaves::exchange(cut_, state);
    std::vector<Box> boxes;
    std::vector<double> held;
    state("changes.cut_boxes", boxes);
    state("changes.cut_held", held);
    state.require(boxes.size() == held.size(), "changes.cut_held", "has another length");
    cuts_.clear();
    for (std::size_t i = 0; i < boxes.size(); ++i) cuts_.push_back({boxes[i], held[i]});
    std::vector<LeafIndex> lowered;
    state("changes.lowered", lowered);
    state("changes.lowered_boxes", boxes);
    state.require(boxes.size() == lowered.size(), "changes.lowered", "has another length");
    require_below(state, "changes.lowered", lowered, leaves);
    lowered_.clear();
    for (std::size_t i = 0; i < boxes.size(); ++i) lowered_.push_back({lowered[i], boxes[i]});
}

}  // namespace controlspace
