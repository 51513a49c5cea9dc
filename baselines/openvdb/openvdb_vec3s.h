#pragma once

#include <memory>

#include "controlspace/space/control_space_builder.h"
#include "controlspace/space/space_options.h"

namespace controlspace {

/// The form in which other programs could read a field of metrics: two of OpenVDB's own Vec3S
/// trees, dense over the domain, one of (xx, yy, zz) and one of (xy, xz, yz), in floats; a metric
/// per vertex, trilinear. So it holds a metric to some 1e-7 of its lengths, and a query looks every
/// value up twice. Anisotropies above about 1e3 are not for floats: what they round may be no
/// metric.
///
/// Footprint as make_openvdb_grid has it. Voxels as `choose_voxels` has them, which throws
/// InputError, as this does where later sources are to come: their field would hang on rounding.
std::unique_ptr<ControlSpaceBuilder> make_openvdb_vec3s(const SpaceOptions& options);

}  // namespace controlspace
