#include "trees/regradation/vertex_changes.h"

#include <algorithm>

namespace controlspace {

void VertexChanges::begin(std::size_t leaves, std::size_t vertices) {
    cut_.begin(leaves);
    vertices_ = vertices;
    cut_corners_.clear();
    touched_.clear();
}

// Neighbours along an edge that is not cut, or in another leaf too, still are; then they may be
// doubted more than need be.
void VertexChanges::cut(LeafIndex leaf, const Corners& corners) {
    if (!cut_.is_old(leaf)) return;
    cut_.enter(leaf);
    cut_corners_.push_back(corners);
}

std::size_t VertexChanges::count(std::size_t) {
    std::sort(touched_.begin(), touched_.end());
    touched_.erase(std::unique(touched_.begin(), touched_.end()), touched_.end());
    return touched_.size();
}

}  // namespace controlspace
