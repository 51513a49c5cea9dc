// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>

#include "controlspace/geometry/box.h"
#include "controlspace/mesh/mesh_run.h"
#include "controlspace/mesh/part.h"
#include "controlspace/space/control_space.h"

namespace controlspace {

/// Gmsh's ways to fill a volume.
enum class GmshAlgorithm {
    delaunay,  ///< for quality
    hxt,       ///< ten times as fast
};

/// Gmsh makes edges longer than the sizes it is given, as it bounds circumradii: what sizes are
/// multiplied by, the same for every field, so that edges come out as long as requested. The mean
/// metric length is then near 1 and L_R near its largest.
double standard_factor(GmshAlgorithm algorithm);

/// Default quality below which tetrahedra are improved: what is worth its
/// time. On the paper's sphere (0.03, 340,000 to 400,000 tetrahedra), L_R is 0.800 in 13 s by
/// Delaunay at 0.7 and 0.806 in 19 s at 0.75; by HXT 0.676 in 0.9 s without improvement, 0.729 in
/// 3 s at 0.6 and 0.772 in 13 s at 0.7.
double standard_optimize(GmshAlgorithm algorithm);

struct GmshOptions {
    GmshAlgorithm algorithm = GmshAlgorithm::delaunay;
    std::optional<double> factor = {};    ///< of sizes; none: standard_factor
    std::optional<double> optimize = {};  ///< quality, Gmsh's gamma; none: standard_optimize
    /// With one, Delaunay makes the same mesh every time; HXT does in a program's first call only.
    int threads = 1;
    double max_tets = 5e7;  ///< a field that requests more, by estimate, is refused
    bool reports = false;   ///< Gmsh writes warnings and errors to standard error
    /// What is filled, within the domain; none: the domain.
    std::shared_ptr<const Part> part = {};
};

/// Fills `domain`, or the part in it, with tetrahedra of the size that `field` requests.
///
/// Runs in a GmshSession: what else a program has open in Gmsh is closed. Throws InputError for
/// options out of range, a part that is not closed or not inside `domain`, a field that is not
/// positive definite somewhere or requests too many tetrahedra, and what Gmsh could not do, in its
/// words. What the field throws passes through.
MeshRun mesh_with_gmsh(const Box& domain, const ControlSpace& field,
                       const GmshOptions& options = {});

}  // namespace controlspace
