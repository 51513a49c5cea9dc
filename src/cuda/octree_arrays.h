// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "controlspace/geometry/box.h"
#include "controlspace/space/control_space.h"
#include "cuda/octree_view.h"

namespace controlspace {

/// The arrays of an OctreeView.
template <class Number>
class OctreeArrays {
public:
    using View = OctreeView<Number>;

    /// Of K_oL, K_oLB or K_oV, compact or not. Throws InputError for any other structure.
    explicit OctreeArrays(const ControlSpace& field);

    /// Numbers of a value: 1 where all metrics are isotropic, else 6.
    int numbers() const { return metrics_.empty() ? 1 : 6; }

    /// Calls put(array) for each array, which returns a pointer to it or to a copy, and makes the
    /// view of these pointers.
    template <class Put>
    View view(const Put& put) const {
        View view;
        for (std::size_t a = 0; a < 3; ++a) {
            view.axes[a] = axes_[a];
            view.axes[a].planes = put(planes_[a]);
        }
        view.starts = put(starts_);
        view.nodes = put(nodes_);
        if (!leaves_.empty()) view.leaves = put(leaves_);
        view.lengths = put(lengths_);
        view.metrics = put(metrics_);
        return view;
    }
    View view() const {
        return view([](const auto& array) { return array.data(); });
    }

private:
    std::array<typename View::Axis, 3> axes_;
    std::array<std::vector<double>, 3> planes_;
    std::vector<std::uint32_t> starts_;
    std::vector<typename View::Node> nodes_;
    std::vector<typename View::Leaf> leaves_;
    std::vector<typename View::template Value<1>> lengths_;  // or:
    std::vector<typename View::template Value<6>> metrics_;
};

}  // namespace controlspace
