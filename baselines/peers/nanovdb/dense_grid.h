#pragma once

#include <nanovdb/util/GridHandle.h>
#include <openvdb/Types.h>

#include "baselines/lattice/lattice_data.h"

namespace controlspace {

/// A dense NanoVDB grid over a lattice, with value_of(metric) of each node: from OpenVDB's, whose
/// headers take long to compile.
nanovdb::GridHandle<nanovdb::HostBuffer> dense_nano_grid(const LatticeData& data,
                                                         openvdb::Vec3s (*value_of)(const Metric&));

/// Bytes of an OpenVDB grid that it is made from.
double dense_vec3s_bytes(const Vector& nodes);

}  // namespace controlspace
