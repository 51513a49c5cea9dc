// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "controlspace/gmsh/gmsh_mesher.h"

namespace controlspace {

/// mesh_with_gmsh in a process of its own, as Gmsh may crash or not end: this program is run again
/// with `gmsh_job`, and loads the field or, where that cannot be saved, asks this process for it.
/// Throws InputError as mesh_with_gmsh, and with Gmsh's last words where it crashes or takes longer
/// than `time_limit_s`. Files are exchanged in a new folder in `folder`.
MeshRun mesh_apart(const Box& domain, const ControlSpace& field, const GmshOptions& options,
                   const std::filesystem::path& folder, double time_limit_s);

/// The command of the other process, which no help names, and what it does in its folder.
inline constexpr const char* gmsh_job = "gmsh-job";
int run_gmsh_job(const std::filesystem::path& folder);

}  // namespace controlspace
