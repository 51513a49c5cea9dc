// SPDX-License-Identifier: Apache-2.0
#include "study/mesh_settings.h"

#include "refuse.h"
#include "study/member_of.h"

namespace controlspace {
namespace {

Access<MeshSettings> kinds_of_files() {
    Access<MeshSettings> access;
    access.type = ValueType::text;
    access.at_most = 0;
    access.set = [](MeshSettings& s, const Values& values) {
        s.files.clear();
        for (const Value& value : values) {
            const std::string& kind = value.text();
            if (kind == "none" && values.size() == 1) return;
            if (kind != "msh" && kind != "mesh" && kind != "vtu") {
                refuse("unknown kind of file '{}': give some of msh, mesh, vtu, or none", kind);
            }
            s.files.push_back(kind);
        }
    };
    access.get = [](const MeshSettings& s) {
        return s.files.empty() ? Values{"none"} : Values(s.files.begin(), s.files.end());
    };
    return access;
}

}  // namespace

std::span<const Parameter<MeshSettings>> mesh_parameters() {
    constexpr auto gmsh = &MeshSettings::gmsh;
    constexpr auto mmg = &MeshSettings::mmg;
    static const std::vector<Parameter<MeshSettings>> all{
        {"part", "",
         "What is meshed: a closed surface (.stl, .obj, .ply, .off) or a solid (.step, .stp, "
         ".iges, "
         ".igs, .brep); box: the domain; left out: INPUT, if it is such a file",
         text<MeshSettings>(&MeshSettings::part)},
        {"part_crease", "degree",
         "Angle between triangles of a part from which on their edge is kept",
         number<MeshSettings>(&MeshSettings::part_crease, within(1, 180))},
        {"mesher", "",
         "delaunay or hxt (Gmsh), mmg (MMG3D), or auto: delaunay where the field is isotropic, "
         "else mmg",
         word<MeshSettings>(&MeshSettings::mesher)},
        {"factor", "",
         "Factor of lengths, as meshers make longer edges than requested; left out: 0.77 for "
         "delaunay, 0.7 for hxt, 0.96 for mmg",
         number<MeshSettings>(of(gmsh, &GmshOptions::factor),
                              [](double x) { return within(0, 100)(positive(x)); })},
        {"optimize", "",
         "Gmsh: quality below which tetrahedra are improved, 0 to 0.95; left out: 0.75 for "
         "delaunay, 0.6 for hxt",
         number<MeshSettings>(of(gmsh, &GmshOptions::optimize), within(0, 0.95))},
        {"mesh_threads", "", "Gmsh: threads; with more than one, meshes differ in detail",
         number<MeshSettings>(of(gmsh, &GmshOptions::threads), within(1, 1024))},
        {"max_tets", "", "Most tetrahedra that a field may request, by estimate",
         number<MeshSettings>(of(gmsh, &GmshOptions::max_tets), positive)},
        {"mmg", "", "MMG's program mmg3d_O3; left out: as found in PATH",
         text<MeshSettings>(of(mmg, &MmgOptions::program))},
        {"start", "",
         "MMG: the mesh it starts from: coarse; or one that Gmsh made for the field's smallest "
         "lengths, delaunay, hxt, which MMG only finishes",
         word<MeshSettings>(&MeshSettings::start)},
        {"rounds", "",
         "MMG: number of times that the mesh is made anew, each time by the field at its vertices",
         number<MeshSettings>(of(mmg, &MmgOptions::rounds), within(1, 100))},
        {"time_limit", "s", "Time limit of a mesh by Gmsh, and of each round of MMG",
         number<MeshSettings>(of(mmg, &MmgOptions::time_limit_s), positive)},
        {"exact", "", "Mesh the exact field too, to compare with",
         word<MeshSettings>(&MeshSettings::exact)},
        {"files", "",
         "Files of each mesh: msh (Gmsh), mesh (Medit, with its .sol), vtu (VTK); or none",
         kinds_of_files()},
    };
    return all;
}

}  // namespace controlspace
