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
/// addition (nvcc: --fmad=false). Pointers are of the side that reads.
template <class Number>
struct OctreeView {
    static constexpr std::uint32_t leaf_bit = 1u << 31;

    struct Node {
        std::uint32_t children[8];  ///< an inner node, or a leaf with leaf_bit; x fastest
        double at[3];               ///< planes; infinite along axes that are not cut
    };
    /// One axis of a uniform grid of cells that lie in one leaf, or contain whole ones.
    struct Axis {
        double low = 0, per_length = 0;
        int cells = 1;
        const double* planes = nullptr;  ///< cells + 1; the outermost are not-a-number
        const double* cuts = nullptr;    ///< places of all cuts, which `faces` number
    };

    Axis axes[3];
    const std::uint32_t* starts = nullptr;  ///< for each cell, x fastest: a node or leaf
    const Node* nodes = nullptr;
    const std::uint32_t* faces = nullptr;    ///< of each leaf: three low, three high
    const std::uint32_t* corners = nullptr;  ///< of each leaf, x fastest; null: it has one value
    const Number* values = nullptr;          ///< lengths, or six numbers of a metric each
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

/// The field at x: one length, or the six numbers of a metric.
template <int numbers, class Number>
CONTROLSPACE_ON_BOTH_SIDES void answer(const OctreeView<Number>& tree, const double* x,
                                       double* out) {
    const std::size_t leaf = leaf_at(tree, x);
    if (tree.corners == nullptr) {
        for (int n = 0; n < numbers; ++n) out[n] = tree.values[leaf * numbers + n];
        return;
    }
    double side[3][2];
    for (int a = 0; a < 3; ++a) {
        constexpr double least = 2.2250738585072014e-308;  // flat boxes: the least normal number
        const double low = tree.axes[a].cuts[tree.faces[6 * leaf + a]];
        const double high = tree.axes[a].cuts[tree.faces[6 * leaf + 3 + a]];
        const double edge = high - low;
        double place = x[a] > low ? x[a] : low;
        place = place < high ? place : high;
        side[a][1] = (place - low) / (edge > least ? edge : least);
        side[a][0] = 1 - side[a][1];
    }
    for (int n = 0; n < numbers; ++n) out[n] = 0;
    for (int c = 0; c < 8; ++c) {
        const double weight = side[0][c & 1] * side[1][c >> 1 & 1] * side[2][c >> 2];
        const Number* const value = tree.values + std::size_t{tree.corners[8 * leaf + c]} * numbers;
        for (int n = 0; n < numbers; ++n) out[n] += weight * value[n];
    }
}

}  // namespace controlspace
