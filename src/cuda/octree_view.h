// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

#ifdef __CUDACC__
#define CONTROLSPACE_ON_BOTH_SIDES __host__ __device__
#else
#define CONTROLSPACE_ON_BOTH_SIDES
#endif

namespace controlspace {

/// An octree as arrays of plain numbers, and how to answer from it: the same functions on a GPU and
/// on a processor, where the tests call them. They compute what octrees in memory compute, in the
/// same order, so that answers are the same to the bit where no multiplication is fused with an
/// addition (nvcc: --fmad=false). Pointers are of the side that reads. Structures are read as a
/// whole, sixteen bytes at a time: what limits a GPU is how many reads there are.
template <class Number>
struct OctreeView {
    static constexpr std::uint32_t leaf_bit = 1u << 31;

    struct Node {
        double at[3];  ///< planes; infinite along axes that are not cut
        /// An inner node, or a leaf with leaf_bit; x fastest.
        alignas(32) std::uint32_t children[8];
    };
    /// One axis of a uniform grid of cells that lie in one leaf, or contain whole ones.
    struct Axis {
        double low = 0, per_length = 0;
        int cells = 1;
        const double* planes = nullptr;  ///< cells + 1; the outermost are not-a-number
    };
    /// With values at its corners.
    struct alignas(16) Leaf {
        double low[3], high[3];
        std::uint32_t corners[8];  ///< numbers of values, x fastest
    };
    /// A length, or the six numbers of a metric.
    template <int numbers>
    struct alignas(numbers == 1 ? sizeof(Number) : 16) Value {
        Number of[numbers];
    };

    Axis axes[3];
    const std::uint32_t* starts = nullptr;  ///< for each cell, x fastest: a node or leaf
    const Node* nodes = nullptr;
    const Leaf* leaves = nullptr;  ///< null: a leaf has one value, of its own number
    const Value<1>* lengths = nullptr;
    const Value<6>* metrics = nullptr;

    template <int numbers>
    CONTROLSPACE_ON_BOTH_SIDES const Value<numbers>* values() const {
        if constexpr (numbers == 1) {
            return lengths;
        } else {
            return metrics;
        }
    }
};

/// The cell that holds x: the quotient is off by rounding at most.
template <class Axis>
CONTROLSPACE_ON_BOTH_SIDES int cell_of(const Axis& axis, double x) {
    const double most = axis.cells - 1;
    double steps = (x - axis.low) * axis.per_length;
    steps = steps > 0 ? steps : 0;
    steps = steps < most ? steps : most;
    const int i = static_cast<int>(steps);
    return i + (x > axis.planes[i + 1] ? 1 : 0) - (x <= axis.planes[i] ? 1 : 0);
}

template <class Number>
CONTROLSPACE_ON_BOTH_SIDES std::uint32_t leaf_at(const OctreeView<Number>& tree, const double* x) {
    std::size_t cell = 0;
    for (int a = 2; a >= 0; --a) {
        cell = cell * static_cast<std::size_t>(tree.axes[a].cells) +
               static_cast<std::size_t>(cell_of(tree.axes[a], x[a]));
    }
    std::uint32_t part = tree.starts[cell];
    while ((part & tree.leaf_bit) == 0) {
        const auto& node = tree.nodes[part];
        part = node.children[(x[0] > node.at[0] ? 1 : 0) + (x[1] > node.at[1] ? 2 : 0) +
                             (x[2] > node.at[2] ? 4 : 0)];
    }
    return part & ~tree.leaf_bit;
}

/// The field at x, one length or the six numbers of a metric, where leaves have one value each.
template <int numbers, class Number>
CONTROLSPACE_ON_BOTH_SIDES void answer_of_leaf(const OctreeView<Number>& tree, const double* x,
                                               double* out) {
    const auto value = tree.template values<numbers>()[leaf_at(tree, x)];
    for (int n = 0; n < numbers; ++n) out[n] = value.of[n];
}

/// The same where they have values at their corners: trilinear.
template <int numbers, class Number>
CONTROLSPACE_ON_BOTH_SIDES void answer_of_corners(const OctreeView<Number>& tree, const double* x,
                                                  double* out) {
    const auto* const values = tree.template values<numbers>();
    const auto leaf = tree.leaves[leaf_at(tree, x)];
    double side[3][2];
    for (int a = 0; a < 3; ++a) {
        constexpr double least = 2.2250738585072014e-308;  // flat boxes: the least normal number
        const double edge = leaf.high[a] - leaf.low[a];
        double place = x[a] > leaf.low[a] ? x[a] : leaf.low[a];
        place = place < leaf.high[a] ? place : leaf.high[a];
        side[a][1] = (place - leaf.low[a]) / (edge > least ? edge : least);
        side[a][0] = 1 - side[a][1];
    }
    double sum[numbers] = {};
    for (int c = 0; c < 8; ++c) {
        const double weight = side[0][c & 1] * side[1][c >> 1 & 1] * side[2][c >> 2];
        const auto value = values[leaf.corners[c]];
        for (int n = 0; n < numbers; ++n) sum[n] += weight * value.of[n];
    }
    for (int n = 0; n < numbers; ++n) out[n] = sum[n];
}

}  // namespace controlspace
