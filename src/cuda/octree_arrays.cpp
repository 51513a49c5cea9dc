#include "cuda/octree_arrays.h"

#include <algorithm>
#include <string>

#include "controlspace/space/control_space_file.h"
#include "controlspace/space/detail/saved.h"
#include "controlspace/trees/detail/corners.h"
#include "controlspace/trees/detail/topology_state.h"
#include "refuse.h"
#include "trees/topology/leaf_faces.h"

namespace controlspace {

template <class Number>
OctreeArrays<Number>::OctreeArrays(const ControlSpace& field) {
    const auto recipe = recipe_of(field);
    const auto* const saved = dynamic_cast<const Saved*>(&field);
    const std::string id = recipe && saved != nullptr ? recipe->structure : "another structure";
    if (id != "K_oL" && id != "K_oLB" && id != "K_oV") {
        refuse("{} cannot be copied to a GPU: give K_oL, K_oLB or K_oV", id);
    }
    // What a file of it would hold.
    StateWriter writer;
    saved->save(writer);
    const StateReader state(writer.bytes(), id);
    const Box domain = field.domain();
    const auto tree = load_topology<OctreeNode>(domain, state);
    std::vector<Metric> metrics;
    state("nodes.field", metrics);
    std::vector<Corners> corners;
    if (state.has("vertices.of_leaves")) state("vertices.of_leaves", corners);

    const auto bits_of = [](Ref part) {
        return part.index() | (part.is_leaf() ? View::leaf_bit : 0);
    };
    for (const OctreeNode& node : tree.nodes()) {
        auto& added = nodes_.emplace_back();
        std::ranges::transform(node.children, added.children, bits_of);
        std::ranges::copy(node.at, added.at);
    }
    numbers_ = std::ranges::all_of(metrics, is_isotropic) ? 1 : 6;
    for (const Metric& m : metrics) {
        const double all[] = {m.xx, m.yy, m.zz, m.xy, m.xz, m.yz};
        for (int n = 0; n < numbers_; ++n) values_.push_back(static_cast<Number>(all[n]));
    }
    const CutPlanes cuts(tree);
    for (std::size_t a = 0; a < 3; ++a) {
        const auto axis = static_cast<Axis>(a);
        const std::size_t last = cuts.number(axis, domain.high[axis]);
        for (std::size_t i = 0; i <= last; ++i) cuts_[a].push_back(cuts.at(axis, i));
    }
    for (const Corners& of_leaf : corners) {
        corners_.insert(corners_.end(), of_leaf.begin(), of_leaf.end());
    }
    if (!corners.empty()) {
        faces_.resize(6 * tree.leaves());
        for_each_faces<std::uint32_t>(tree, cuts, [&](LeafIndex leaf, const auto& of_leaf) {
            std::ranges::copy(of_leaf.low, &faces_[6 * std::size_t{leaf}]);
            std::ranges::copy(of_leaf.high, &faces_[6 * std::size_t{leaf} + 3]);
        });
    }

    for (const Ref start : tree.jumps().refs()) starts_.push_back(bits_of(start));
    for (std::size_t a = 0; a < 3; ++a) {
        const auto& cells = tree.jumps().axes()[a];
        axes_[a] = {cells.low, cells.per_length, cells.count(), nullptr, nullptr};
        planes_[a] = cells.planes;
    }
}

template class OctreeArrays<float>;
template class OctreeArrays<double>;

}  // namespace controlspace
