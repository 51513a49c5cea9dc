#pragma once

#include <filesystem>

#include "controlspace/mesh/tet_mesh.h"
#include "controlspace/metric/metric_field.h"

namespace controlspace {

/// Writes `mesh` with the metric at its vertices as a VTK unstructured grid, for ParaView, PyVista
/// and VTK: raw binary appended to XML. Throws InputError if that fails; no part of a file is left.
///
/// At points: `length_tensor`, M by the components XX YY ZZ XY YZ XZ, and `h_min`, its smallest
/// length. At cells: `quality` (see Conformity) and `edge_length`, the mean metric length of the
/// six edges.
void write_vtu(const std::filesystem::path& path, const TetMesh& mesh, const MetricField& field);

}  // namespace controlspace
