#include "spaces/leaf_changes.h"

namespace controlspace {

void LeafChanges::begin(std::size_t leaves) {
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

void LeafChanges::lower(const LeafPlace& place) {
    if (cut_.is_old(place.leaf)) lowered_.push_back({place.leaf, place.box});
}

}  // namespace controlspace
