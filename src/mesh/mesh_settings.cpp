#include "mesh/mesh_settings.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>

#include "error.h"
#include "study/setting_values.h"

namespace controlspace {
namespace {

constexpr std::array<std::pair<Mesher, std::string_view>, 4> meshers{
    {{Mesher::automatic, "auto"},
     {Mesher::delaunay, "delaunay"},
     {Mesher::hxt, "hxt"},
     {Mesher::mmg, "mmg"}}};

Mesher mesher_of(const std::string& word) {
    for (const auto& [mesher, name] : meshers) {
        if (name == word) return mesher;
    }
    throw InputError(fmt::format("unknown mesher '{}': give auto, delaunay, hxt, mmg", word));
}

void set_files(MeshSettings& s, const SettingValues& values) {
    s.files.clear();
    for (const SettingValue& value : values) {
        const std::string& kind = text(value);
        if (kind == "none" && values.size() == 1) return;
        if (kind != "msh" && kind != "mesh" && kind != "vtu") {
            throw InputError(fmt::format(
                "unknown kind of file '{}': give some of msh, mesh, vtu, or none", kind));
        }
        s.files.push_back(kind);
    }
}

SettingValues optional_number(const std::optional<double>& x) {
    return x ? one(*x) : SettingValues{};
}

constexpr auto number_type = ValueType::number;
constexpr auto whole = ValueType::whole_number;
constexpr auto text_type = ValueType::text;

const Setting<MeshSettings> table[] = {
    {"mesher", text_type, 1, "",
     "delaunay or hxt (Gmsh), mmg (MMG3D), or auto: delaunay where the field is isotropic, else "
     "mmg",
     [](MeshSettings& s, const SettingValues& v) { s.mesher = mesher_of(text(v.front())); },
     [](const MeshSettings& s) { return SettingValues{std::string(name_of(s.mesher))}; }},
    {"factor", number_type, 1, "",
     "Gmsh: of the sizes it is given, which its edges exceed; left out: 0.77 for delaunay, 0.7 for "
     "hxt",
     [](MeshSettings& s, const SettingValues& v) {
         s.factor = within(positive(number(v.front())), 0, 100);
     },
     [](const MeshSettings& s) { return optional_number(s.factor); }},
    {"optimize", number_type, 1, "",
     "Gmsh: quality below which tetrahedra are improved, 0 to 0.95; left out: 0.7 for delaunay, "
     "0.6 for hxt",
     [](MeshSettings& s, const SettingValues& v) {
         s.optimize = within(number(v.front()), 0, 0.95);
     },
     [](const MeshSettings& s) { return optional_number(s.optimize); }},
    {"mesh_threads", whole, 1, "", "Gmsh: threads; with more than one, meshes differ in detail",
     [](MeshSettings& s, const SettingValues& v) {
         s.threads = static_cast<int>(within(number(v.front()), 1, 1024));
     },
     [](const MeshSettings& s) { return one(s.threads); }},
    {"max_tets", number_type, 1, "", "Most tetrahedra that a field may ask for, by estimate",
     [](MeshSettings& s, const SettingValues& v) { s.max_tets = positive(number(v.front())); },
     [](const MeshSettings& s) { return one(s.max_tets); }},
    {"mmg", text_type, 1, "", "MMG's program mmg3d_O3; left out: as found in PATH",
     [](MeshSettings& s, const SettingValues& v) { s.mmg = text(v.front()); },
     [](const MeshSettings& s) { return s.mmg.empty() ? SettingValues{} : SettingValues{s.mmg}; }},
    {"rounds", whole, 1, "",
     "MMG: how often the mesh is made anew, each time by the field at its "
     "vertices",
     [](MeshSettings& s, const SettingValues& v) {
         s.rounds = static_cast<int>(within(number(v.front()), 1, 100));
     },
     [](const MeshSettings& s) { return one(s.rounds); }},
    {"time_limit", number_type, 1, "", "MMG: of each round [s]",
     [](MeshSettings& s, const SettingValues& v) { s.time_limit_s = positive(number(v.front())); },
     [](const MeshSettings& s) { return one(s.time_limit_s); }},
    {"exact", text_type, 1, "", "yes or no: mesh the exact field too, to compare with",
     [](MeshSettings& s, const SettingValues& v) {
         const std::string& word = text(v.front());
         if (word != "yes" && word != "no") throw InputError("give yes or no");
         s.exact = word == "yes";
     },
     [](const MeshSettings& s) { return SettingValues{std::string(s.exact ? "yes" : "no")}; }},
    {"files", text_type, 0, "",
     "Files of each mesh: msh (Gmsh), mesh (Medit, with its .sol), vtu (VTK); or none", set_files,
     [](const MeshSettings& s) {
         return s.files.empty() ? SettingValues{std::string("none")}
                                : SettingValues(s.files.begin(), s.files.end());
     }},
};

}  // namespace

std::string_view name_of(Mesher mesher) {
    return std::find_if(meshers.begin(), meshers.end(),
                        [&](const auto& entry) { return entry.first == mesher; })
        ->second;
}

std::span<const Setting<MeshSettings>> mesh_settings() { return table; }

}  // namespace controlspace
