#include "spaces/vertex_changes.h"

#include <algorithm>

namespace controlspace {

void VertexChanges::begin(std::size_t leaves, std::size_t vertices) {
    cut_.begin(leaves);
    vertices_ = vertices;
    lost_links_.clear();
    touched_.clear();
}

// An edge that is not cut, or belongs to another leaf too, is still a link; then its ends may be
// doubted more than need be.
void VertexChanges::cut(LeafIndex leaf, const Corners& corners) {
    if (!cut_.is_old(leaf)) return;
    cut_.enter(leaf);
    for_each_edge(corners, [&](NodeIndex a, NodeIndex b) { lost_links_.emplace_back(a, b); });
}

std::size_t VertexChanges::count() {
    std::sort(touched_.begin(), touched_.end());
    touched_.erase(std::unique(touched_.begin(), touched_.end()), touched_.end());
    return touched_.size();
}

}  // namespace controlspace
