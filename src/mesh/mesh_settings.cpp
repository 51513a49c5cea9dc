#include "mesh/mesh_settings.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <utility>

#include "controlspace/error.h"
#include "study/setting_values.h"

namespace controlspace {
namespace {

template <class Enum, std::size_t n>
using Words = std::array<std::pair<Enum, std::string_view>, n>;

constexpr Words<Mesher, 4> meshers{{{Mesher::automatic, "auto"},
                                    {Mesher::delaunay, "delaunay"},
                                    {Mesher::hxt, "hxt"},
                                    {Mesher::mmg, "mmg"}}};
constexpr Words<MeshStart, 3> starts{
    {{MeshStart::coarse, "coarse"}, {MeshStart::delaunay, "delaunay"}, {MeshStart::hxt, "hxt"}}};

template <class Enum, std::size_t n>
Enum value_of(const Words<Enum, n>& words, const SettingValues& values) {
    std::vector<std::string_view> known;
    for (const auto& [value, word] : words) {
        if (word == text(values.front())) return value;
        known.push_back(word);
    }
    throw InputError(
        fmt::format("unknown value '{}': give {}", text(values.front()), fmt::join(known, ", ")));
}

template <class Enum, std::size_t n>
std::string_view word_of(const Words<Enum, n>& words, Enum value) {
    const auto found = std::find_if(words.begin(), words.end(),
                                    [&](const auto& entry) { return entry.first == value; });
    return found->second;
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
     [](MeshSettings& s, const SettingValues& v) { s.mesher = value_of(meshers, v); },
     [](const MeshSettings& s) { return SettingValues{std::string(name_of(s.mesher))}; }},
    {"factor", number_type, 1, "",
     "Of lengths, as meshers make longer edges than they are asked for; left out: 0.77 for "
     "delaunay, 0.7 for hxt, 0.96 for mmg",
     [](MeshSettings& s, const SettingValues& v) {
         s.factor = within(positive(number(v.front())), 0, 100);
     },
     [](const MeshSettings& s) { return optional_number(s.factor); }},
    {"optimize", number_type, 1, "",
     "Gmsh: quality below which tetrahedra are improved, 0 to 0.95; left out: 0.75 for delaunay, "
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
    {"start", text_type, 1, "",
     "MMG: the mesh it starts from: coarse; or one that Gmsh made for the field's smallest "
     "lengths, "
     "delaunay, hxt, which MMG only finishes",
     [](MeshSettings& s, const SettingValues& v) { s.start = value_of(starts, v); },
     [](const MeshSettings& s) { return SettingValues{std::string(word_of(starts, s.start))}; }},
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

std::string_view name_of(Mesher mesher) { return word_of(meshers, mesher); }

std::span<const Setting<MeshSettings>> mesh_settings() { return table; }

}  // namespace controlspace
