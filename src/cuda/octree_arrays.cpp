// SPDX-License-Identifier: Apache-2.0
#include "cuda/octree_arrays.h"

#include <algorithm>
#include <string>

#include "controlspace/space/control_space_file.h"
#include "refuse.h"
#include "space/saved.h"
#include "trees/topology/corners.h"
#include "trees/topology/topology_state.h"

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
    const auto number = [](double x) { return static_cast<Number>(x); };
    if (std::ranges::all_of(metrics, is_isotropic)) {
        for (const Metric& m : metrics) lengths_.push_back({{number(m.xx)}});
    } else {
        for (const Metric& m : metrics) {
            metrics_.push_back({{number(m.xx), number(m.yy), number(m.zz), number(m.xy),
                                 number(m.xz), number(m.yz)}});
        }
    }
    if (!corners.empty()) {
        leaves_.resize(corners.size());
        tree.for_each_leaf([&](LeafIndex index, const Box& box) {
            typename View::Leaf& leaf = leaves_[index];
            std::ranges::copy(box.low, leaf.low);
            std::ranges::copy(box.high, leaf.high);
            std::ranges::copy(corners[index], leaf.corners);
        });
    }

    for (const Ref start : tree.jumps().refs()) starts_.push_back(bits_of(start));
    for (std::size_t a = 0; a < 3; ++a) {
        const auto& cells = tree.jumps().axes()[a];
        axes_[a] = {cells.low, cells.per_length, cells.count(), nullptr};
        planes_[a] = cells.planes;
    }
}

template class OctreeArrays<float>;
template class OctreeArrays<double>;

}  // namespace controlspace
