// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nanovdb/NanoVDB.h>

#include <cstddef>

namespace controlspace {

/// Dense grids and how to answer from them, trilinear: the same functions on a GPU and on a
/// processor, where the tests call them. They compute what `nanovdb-trilinear` computes, in the
/// same order. Pointers are of the side that reads.
struct NanoView {
    const nanovdb::NanoGrid<float>* lengths = nullptr;                 ///< or, where null:
    const nanovdb::NanoGrid<nanovdb::Vec3f>* diagonals = nullptr;      ///< xx, yy, zz
    const nanovdb::NanoGrid<nanovdb::Vec3f>* off_diagonals = nullptr;  ///< xy, xz, yz
    double low[3] = {}, per_length[3] = {};
    int cells[3] = {};
    int last[3] = {};  ///< node numbers along each axis end here
};

/// visit(node, weight) for the eight nodes around x.
template <class Visit>
__hostdev__ inline void for_each_node(const NanoView& view, const double* x, const Visit& visit) {
    int cell[3];
    double side[3][2];
    for (int a = 0; a < 3; ++a) {
        const double most = view.cells[a];
        double t = (x[a] - view.low[a]) * view.per_length[a];
        t = t > 0 ? t : 0;
        t = t < most ? t : most;
        cell[a] = static_cast<int>(t < most ? t : most - 1);
        side[a][1] = t - cell[a];
        side[a][0] = 1 - side[a][1];
    }
    for (int c = 0; c < 8; ++c) {
        int node[3];
        for (int a = 0; a < 3; ++a) {
            node[a] = cell[a] + (c >> a & 1);
            if (node[a] > view.last[a]) node[a] = view.last[a];
        }
        visit(nanovdb::Coord(node[0], node[1], node[2]),
              side[0][c & 1] * side[1][c >> 1 & 1] * side[2][c >> 2]);
    }
}

/// The length at x.
__hostdev__ inline void answer_length(const NanoView& view, const double* x, double* out) {
    const auto lengths = view.lengths->getAccessor();
    double sum = 0;
    for_each_node(view, x, [&](const nanovdb::Coord& node, double weight) {
        sum += weight * lengths.getValue(node);
    });
    *out = sum;
}

/// The six numbers of the metric at x.
__hostdev__ inline void answer_metric(const NanoView& view, const double* x, double* out) {
    const auto diagonals = view.diagonals->getAccessor();
    const auto off_diagonals = view.off_diagonals->getAccessor();
    double sum[6] = {};
    for_each_node(view, x, [&](const nanovdb::Coord& node, double weight) {
        const nanovdb::Vec3f& first = diagonals.getValue(node);
        const nanovdb::Vec3f& rest = off_diagonals.getValue(node);
        for (int n = 0; n < 3; ++n) sum[n] += weight * first[n];
        for (int n = 0; n < 3; ++n) sum[3 + n] += weight * rest[n];
    });
    for (int n = 0; n < 6; ++n) out[n] = sum[n];
}

}  // namespace controlspace
