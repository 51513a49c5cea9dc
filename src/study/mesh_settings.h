// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

#include "controlspace/gmsh/gmsh_mesher.h"
#include "controlspace/study/parameter.h"
#include "mesh/mmg_mesher.h"

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
    GmshOptions gmsh;  ///< its factor is MMG's too, and its part what the part's file holds
    MmgOptions mmg;
    bool exact = true;  ///< mesh the exact field too
    std::string part;   ///< a file; "box": the domain; empty: the input, if it is a part
    double part_crease = 30;
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
struct Words<bool> {
    static constexpr Word<bool> table[] = {{true, "yes", "it is"}, {false, "no", "it is not"}};
};
template <>
struct Words<MeshStart> {
    static constexpr Word<MeshStart> table[] = {
        {MeshStart::coarse, "coarse", "a coarse mesh"},
        {MeshStart::delaunay, "delaunay", "made by Gmsh for the smallest lengths of the field"},
        {MeshStart::hxt, "hxt", "the same"}};
};

}  // namespace controlspace
