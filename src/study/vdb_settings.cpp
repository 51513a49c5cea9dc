#include "study/vdb_settings.h"

#include "study/setting_values.h"

namespace controlspace {
namespace {

constexpr auto number_type = ValueType::number;
constexpr auto text_type = ValueType::text;

SettingValues known(const std::string& name) {
    return name.empty() ? SettingValues{} : SettingValues{name};
}
SettingValues known(double length) { return length == 0 ? SettingValues{} : one(length); }

const Setting<Study> table[] = {
    {"vdb_size", number_type, 1, "", "Sources of a .vdb: length at its surface [length]",
     [](Study& s, const SettingValues& v) { s.sources.surface.h = positive(number(v.front())); },
     [](const Study& s) { return known(s.sources.surface.h); }},
    {"vdb_size_per_radius", number_type, 1, "",
     "Sources of a .vdb: length at its surface [smaller radius of curvature]",
     [](Study& s, const SettingValues& v) {
         s.sources.surface.per_radius = positive(number(v.front()));
     },
     [](const Study& s) { return known(s.sources.surface.per_radius); }},
    {"vdb_grid", text_type, 1, "",
     "Sources of a .vdb: the level set or fog; left out: the only grid of the file",
     [](Study& s, const SettingValues& v) { s.sources.surface.grid = text(v.front()); },
     [](const Study& s) { return known(s.sources.surface.grid); }},
    {"vdb_isovalue", number_type, 1, "",
     "Sources of a .vdb: where its surface is; left out: at 0 of a level set, 0.5 of a fog",
     [](Study& s, const SettingValues& v) { s.sources.surface.isovalue = number(v.front()); },
     [](const Study& s) {
         const auto& isovalue = s.sources.surface.isovalue;
         return isovalue ? one(*isovalue) : SettingValues{};
     }},
    {"field_file", text_type, 1, "", "The .vdb of the field file",
     [](Study& s, const SettingValues& v) { s.sources.field.file = text(v.front()); },
     [](const Study& s) { return known(s.sources.field.file.string()); }},
    {"field_grid", text_type, 1, "",
     "Its grid of lengths, or of densities; left out: metric_diag and metric_off",
     [](Study& s, const SettingValues& v) { s.sources.field.vdb.grid = text(v.front()); },
     [](const Study& s) { return known(s.sources.field.vdb.grid); }},
    {"field_density_sizes", number_type, 2, "",
     "Lengths at densities 1 and 0 of that grid [length]; left out: the grid holds lengths",
     [](Study& s, const SettingValues& v) {
         s.sources.field.vdb.density = {positive(number(v.front())), positive(number(v.back()))};
     },
     [](const Study& s) {
         const auto& sizes = s.sources.field.vdb.density;
         return sizes ? SettingValues{sizes->finest, sizes->coarsest} : SettingValues{};
     }},
};

}  // namespace

std::span<const Setting<Study>> vdb_settings() { return table; }

}  // namespace controlspace
