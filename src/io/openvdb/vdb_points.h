#pragma once

#include <openvdb/Grid.h>

#include <span>

#include "controlspace/sources/point_source.h"

namespace controlspace {

/// The sources as a grid of points: positions, pscale (smallest length), metric_diag, metric_off.
openvdb::GridBase::Ptr make_points_grid(std::span<const PointSource> sources,
                                        const openvdb::math::Transform& transform);

}  // namespace controlspace
