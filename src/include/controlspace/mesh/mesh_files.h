// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "controlspace/mesh/tet_mesh.h"
#include "controlspace/space/control_space.h"

namespace controlspace {

// Files of meshes. What cannot be read throws InputError with the place in the file. What cannot be
// written throws InputError and leaves no part of a file.

/// Vertices, triangles and tetrahedra of a Medit file (.mesh, or binary .meshb), whose tetrahedra
/// are turned to positive volume.
TetMesh read_medit_mesh(const std::filesystem::path& path);

/// Writes a Medit file, text or binary by the name's ending (.mesh, .meshb), with reference 0 at
/// vertices and 1 at elements.
void write_medit_mesh(const std::filesystem::path& path, const TetMesh& mesh);

/// Writes Gmsh's own format, MSH 4.1, binary: one volume and its boundary as one surface. Gmsh's
/// library is not needed.
void write_msh(const std::filesystem::path& path, const TetMesh& mesh);

/// Writes a VTK unstructured grid (.vtu) of tetrahedra, for ParaView and PyVista, without VTK.
///
/// At points: `length_tensor`, the metric M whose eigenvalues are lengths (not M^-2), by the
/// components XX YY ZZ XY YZ XZ, and `h_min`, its smallest length. At cells: `quality` (see
/// Conformity) and `edge_length`, the mean metric length of the six edges.
void write_vtu(const std::filesystem::path& path, const TetMesh& mesh, const ControlSpace& field);

}  // namespace controlspace
