// SPDX-License-Identifier: Apache-2.0
#include "baselines/peers/nanovdb/dense_grid.h"

#include <nanovdb/util/OpenToNanoVDB.h>
#include <openvdb/Grid.h>

#include <algorithm>

#include "baselines/openvdb/dense_tree.h"
#include "baselines/openvdb/vec3s_value.h"
#include "controlspace/geometry/extent.h"

namespace controlspace {

namespace {

template <class Tree, class ValueOf>
NanoHandle dense_grid(const Lattice& lattice, std::span<const Metric> metrics, ValueOf&& value_of) {
    const auto grid = openvdb::Grid<Tree>::create();
    fill_densely(grid->tree(), lattice, [&](NodeIndex node) { return value_of(metrics[node]); });
    return nanovdb::openToNanoVDB<nanovdb::HostBuffer, Tree>(*grid, nanovdb::StatsMode::Disable,
                                                             nanovdb::ChecksumMode::Disable);
}

}  // namespace

DenseNanoGrids::DenseNanoGrids(const Lattice& lattice, std::span<const Metric> metrics)
    : diagonals(dense_grid<openvdb::Vec3STree>(lattice, metrics, diagonal)),
      off_diagonals(dense_grid<openvdb::Vec3STree>(lattice, metrics, off_diagonal)) {}

NanoHandle dense_lengths(const Lattice& lattice, std::span<const Metric> metrics) {
    return dense_grid<openvdb::FloatTree>(lattice, metrics,
                                          [](const Metric& m) { return static_cast<float>(m.xx); });
}

NanoView nano_view(const Box& domain, const Lattice& lattice) {
    NanoView view;
    const Vector edges = divisible_edges(domain);
    for (Axis a = 0; a < 3; ++a) {
        view.last[a] = static_cast<int>(lattice.nodes[static_cast<std::size_t>(a)]) - 1;
        view.cells[a] = std::max(1, view.last[a]);
        view.low[a] = domain.low[a];
        view.per_length[a] = view.cells[a] / edges[a];
    }
    return view;
}

double dense_vec3s_bytes(const Vector& nodes) { return dense_bytes<openvdb::Vec3STree>(nodes); }

}  // namespace controlspace
