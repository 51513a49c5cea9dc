// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "controlspace/mesh/mesh_run.h"
#include "controlspace/space/control_space.h"

namespace controlspace {

/// MMG makes edges slightly longer than requested: the factor of lengths to compensate, the same
/// for every field, for a mean metric length of 1. On a thin layer around a sphere (0.015 across,
/// 0.06 along, 200,000 tetrahedra), L_R is 0.755 in three rounds without it and 0.772 with it.
constexpr double mmg_factor = 0.96;

struct MmgOptions {
    /// MMG's executable mmg3d_O3; empty: as found by find_mmg.
    std::filesystem::path program;
    double factor = mmg_factor;  ///< of lengths
    int rounds = 3;
    double time_limit_s = 900;  ///< of a round
    /// How far curved boundaries may move [length]; 0: MMG's own, which is for parts of length 1.
    double hausdorff = 0;
    /// Where a folder for temporary files is made. It is removed, unless something fails.
    std::filesystem::path folder = ".";
};

/// mmg3d_O3 or mmg3d in PATH; empty if neither is there.
std::filesystem::path find_mmg();

/// The program that `options` name, or find_mmg. Throws InputError if it cannot be run.
std::filesystem::path require_mmg(const MmgOptions& options);

/// Remeshes `start` to the metric that `field` requests, by the program MMG3D. Each round takes the
/// field at the vertices of the mesh that the one before made, and MMG interpolates between them;
/// it does no gradation of its own.
///
/// Throws InputError if MMG is missing, fails, leaves no mesh or takes too long, with its last
/// words and the folder where its files are left; for options out of range; and for a field that is
/// not positive definite somewhere. What the field throws passes through.
MeshRun mesh_with_mmg(const TetMesh& start, const ControlSpace& field, const MmgOptions& options);

}  // namespace controlspace
