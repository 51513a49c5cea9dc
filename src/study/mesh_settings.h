#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "controlspace/mesh/part.h"
#include "controlspace/study/parameter.h"

namespace controlspace {

enum class Mesher {
    automatic,  ///< delaunay for isotropic fields, mmg for others
    delaunay,   ///< Gmsh
    hxt,        ///< Gmsh
    mmg,        ///< MMG3D, started from a mesh made by Gmsh
};

/// The mesh that MMG starts from.
enum class MeshStart { coarse, delaunay, hxt };

/// How `controlspace mesh` makes meshes; what is not given is the mesher's default.
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
    std::string part;   ///< a file; "box": the domain; empty: the input, if it is a part
    double part_crease = 30;
    std::shared_ptr<const Part> body;  ///< what the part's file holds; none: the domain
    std::vector<std::string> files{"msh", "mesh", "vtu"};
};

std::span<const Parameter<MeshSettings>> mesh_parameters();

template <>
struct Words<Mesher> {
    static constexpr Word<Mesher> table[] = {
        {Mesher::automatic, "auto", "delaunay where the field is isotropic, else mmg"},
        {Mesher::delaunay, "delaunay", "Gmsh"},
        {Mesher::hxt, "hxt", "Gmsh"},
        {Mesher::mmg, "mmg", "MMG3D"}};
};
template <>
struct Words<MeshStart> {
    static constexpr Word<MeshStart> table[] = {
        {MeshStart::coarse, "coarse", "a coarse mesh"},
        {MeshStart::delaunay, "delaunay", "made by Gmsh for the smallest lengths of the field"},
        {MeshStart::hxt, "hxt", "the same"}};
};

}  // namespace controlspace
