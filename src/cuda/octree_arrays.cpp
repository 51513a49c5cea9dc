#include "cuda/octree_arrays.h"

#include <algorithm>
#include <limits>
#include <string>

#include "controlspace/space/control_space_file.h"
#include "controlspace/space/detail/saved.h"
#include "controlspace/trees/detail/corners.h"
#include "controlspace/trees/detail/topology_state.h"
#include "refuse.h"
#include "trees/topology/leaf_faces.h"

namespace controlspace {

namespace {

// As those of the tree, which are in the middle, to the bit.
std::vector<double> planes_between(double low, double high, int cells) {
    std::vector<double> planes(static_cast<std::size_t>(cells) + 1);
    planes.front() = low;
    planes.back() = high;
    const auto count = static_cast<std::size_t>(cells);
    for (std::size_t step = count; step > 1; step /= 2) {
        for (std::size_t i = 0; i < count; i += step) {
            planes[i + step / 2] = 0.5 * (planes[i] + planes[i + step]);
        }
    }
    return planes;
}

}  // namespace

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

    for (const OctreeNode& node : tree.nodes()) {
        auto& added = nodes_.emplace_back();
        std::ranges::transform(node.children, added.children, [](Ref child) {
            return child.index() | (child.is_leaf() ? View::leaf_bit : 0);
        });
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
    if (!corners.empty()) faces_.resize(6 * tree.leaves());
    if (!corners.empty()) {
        for_each_faces<std::uint32_t>(tree, cuts, [&](LeafIndex leaf, const auto& of_leaf) {
            std::ranges::copy(of_leaf.low, &faces_[6 * std::size_t{leaf}]);
            std::ranges::copy(of_leaf.high, &faces_[6 * std::size_t{leaf} + 3]);
        });
    }

    // As many levels as give up to four cells a leaf.
    const std::size_t most_cells = 4 * tree.leaves();
    int levels = 0;
    std::array<int, 3> cells{1, 1, 1};
    for (std::size_t all = 1; levels < 24; ++levels) {
        const auto cut = OctreeNode::even_subdivision(domain, levels, domain);
        if (all * static_cast<std::size_t>(cut.children()) > most_cells || cut.children() == 1) {
            break;
        }
        all *= static_cast<std::size_t>(cut.children());
        for (std::size_t a = 0; a < 3; ++a) cells[a] *= cut.cuts[a] ? 2 : 1;
    }
    for (std::size_t a = 0; a < 3; ++a) {
        const auto axis = static_cast<Axis>(a);
        const double low = domain.low[axis], high = domain.high[axis];
        planes_[a] = planes_between(low, high, cells[a]);
        axes_[a] = {low, high > low ? cells[a] / (high - low) : 0, cells[a], nullptr, nullptr};
    }
    const auto middle = [&](std::size_t a, int i) {
        const auto at = planes_[a].begin() + i;
        return 0.5 * (at[0] + at[1]);
    };
    for (int k = 0; k < cells[2]; ++k) {
        for (int j = 0; j < cells[1]; ++j) {
            for (int i = 0; i < cells[0]; ++i) {
                const Point x(middle(0, i), middle(1, j), middle(2, k));
                Ref part = tree.root();
                for (int level = 0; level < levels && !part.is_leaf(); ++level) {
                    const OctreeNode& node = tree.node(part);
                    part = node.children[node.child_with(x)];
                }
                starts_.push_back(part.index() | (part.is_leaf() ? View::leaf_bit : 0));
            }
        }
    }
    for (auto& planes : planes_) {
        planes.front() = planes.back() = std::numeric_limits<double>::quiet_NaN();
    }
}

template class OctreeArrays<float>;
template class OctreeArrays<double>;

}  // namespace controlspace
