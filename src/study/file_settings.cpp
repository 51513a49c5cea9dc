#include "study/file_settings.h"

#include "study/setting_values.h"

namespace controlspace {
namespace {

constexpr auto number_type = ValueType::number;

SettingValues known(double length) { return length == 0 ? SettingValues{} : one(length); }

const Setting<Study> table[] = {
    {"source_array", ValueType::text, 1, "",
     "Sources of a .vtu, .vtp, .msh or .pos: the array or view of sizes (1 component) or "
     "Riemannian metrics (6 or 9); left out: the array named :metric, the only view",
     [](Study& s, const SettingValues& v) { s.sources.in_file.array = text(v.front()); },
     [](const Study& s) {
         const std::string& name = s.sources.in_file.array;
         return name.empty() ? SettingValues{} : SettingValues{name};
     }},
    {"surface_angle", number_type, 1, "",
     "Sources of a surface (.stl, .obj, .ply, .off): part of the circle of curvature that an edge "
     "spans [degrees]",
     [](Study& s, const SettingValues& v) {
         s.sources.in_file.curvature.angle = within(positive(number(v.front())), 0, 180);
     },
     [](const Study& s) { return one(s.sources.in_file.curvature.angle); }},
    {"surface_h_min", number_type, 1, "",
     "Sources of a surface: smallest length; left out: a thousandth of the diagonal of its box "
     "[length]",
     [](Study& s, const SettingValues& v) {
         s.sources.in_file.curvature.h_min = positive(number(v.front()));
     },
     [](const Study& s) { return known(s.sources.in_file.curvature.h_min); }},
    {"surface_h_max", number_type, 1, "",
     "Sources of a surface: largest length; left out: a tenth of that diagonal [length]",
     [](Study& s, const SettingValues& v) {
         s.sources.in_file.curvature.h_max = positive(number(v.front()));
     },
     [](const Study& s) { return known(s.sources.in_file.curvature.h_max); }},
};

}  // namespace

std::span<const Setting<Study>> file_settings() { return table; }

}  // namespace controlspace
