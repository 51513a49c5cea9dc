#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "study/settings.h"

namespace controlspace {

enum class Mesher {
    automatic,  ///< delaunay for isotropic fields, mmg for others
    delaunay,   ///< Gmsh
    hxt,        ///< Gmsh
    mmg,        ///< MMG3D, started from a mesh of Gmsh's
};

/// The mesh that MMG starts from.
enum class MeshStart { coarse, delaunay, hxt };

/// How `controlspace mesh` makes meshes; what is not said is the mesher's own.
struct MeshSettings {
    Mesher mesher = Mesher::automatic;
    MeshStart start = MeshStart::coarse;
    std::optional<double> factor;    ///< of lengths
    std::optional<double> optimize;  ///< Gmsh: quality to improve up to
    int threads = 1;                 ///< Gmsh
    double max_tets = 5e7;
    std::string mmg;  ///< MMG's program; empty: from PATH
    int rounds = 3;   ///< MMG
    double time_limit_s = 900;
    bool exact = true;  ///< mesh the exact field too
    std::vector<std::string> files{"msh", "mesh", "vtu"};
};

/// The word for it in options and results.
std::string_view name_of(Mesher mesher);

std::span<const Setting<MeshSettings>> mesh_settings();

}  // namespace controlspace
