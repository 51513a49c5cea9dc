// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "controlspace/mesh/tet_mesh.h"

namespace controlspace {

/// What a mesh took.
struct MeshCost {
    double seconds = 0;            ///< of meshing, queries included, by the clock
    double processor_seconds = 0;  ///< the same, of processors
    std::size_t queries = 0;       ///< of the field
    double query_seconds = 0;    ///< spent in them; of all threads together, in Gmsh from a sample
    std::size_t peak_bytes = 0;  ///< most memory of a program that was called

    MeshCost& operator+=(const MeshCost& other) {
        seconds += other.seconds;
        processor_seconds += other.processor_seconds;
        queries += other.queries;
        query_seconds += other.query_seconds;
        peak_bytes = peak_bytes > other.peak_bytes ? peak_bytes : other.peak_bytes;
        return *this;
    }
};

struct MeshRun {
    TetMesh mesh;
    MeshCost cost;
    /// The field requested different lengths in different directions, of which Gmsh was given the
    /// smallest.
    bool anisotropic = false;
};

}  // namespace controlspace
