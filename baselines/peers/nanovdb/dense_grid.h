// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nanovdb/util/GridHandle.h>

#include <span>

#include "baselines/peers/nanovdb/nano_view.h"
#include "controlspace/geometry/box.h"
#include "controlspace/gradation/node_graph.h"
#include "controlspace/metric/metric.h"

namespace controlspace {

using NanoHandle = nanovdb::GridHandle<nanovdb::HostBuffer>;

/// Two dense NanoVDB grids over a lattice with the metrics of its nodes in floats: made from
/// OpenVDB's, whose headers take long to compile.
struct DenseNanoGrids {
    DenseNanoGrids(const Lattice& lattice, std::span<const Metric> metrics);

    NanoHandle diagonals, off_diagonals;
};

/// One of the lengths, where all metrics are isotropic.
NanoHandle dense_lengths(const Lattice& lattice, std::span<const Metric> metrics);

/// How to answer in `domain` from grids whose nodes are the lattice's, from vertex to vertex;
/// without the grids themselves.
NanoView nano_view(const Box& domain, const Lattice& lattice);

/// Bytes of an OpenVDB grid that one of them is made from.
double dense_vec3s_bytes(const Vector& nodes);

}  // namespace controlspace
