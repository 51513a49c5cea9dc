// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <span>

#include "controlspace/geometry/box.h"
#include "controlspace/mesh/tet_mesh.h"
#include "controlspace/space/control_space.h"
#include "mesh/mmg_mesher.h"
#include "study/mesh_rows.h"
#include "study/mesh_settings.h"

namespace controlspace {

/// The requested mesher; for `auto`, the one that suits a field of `metrics`.
Mesher chosen_mesher(Mesher requested, std::span<const Metric> metrics);

/// Meshes the box by the row's mesher, and enters times and memory into the row. Exceptions of the
/// mesher pass through.
TetMesh make_mesh(const Box& domain, const ControlSpace& field, const MeshSettings& settings,
                  const std::filesystem::path& folder, MeshRow& row);

/// Writes a mesh in the settings' formats, to `stem` with their endings. Throws InputError.
void write_mesh(const std::filesystem::path& stem, const TetMesh& mesh, const ControlSpace& field,
                const MeshSettings& settings);

}  // namespace controlspace
