#include "study/field_settings.h"

#include "study/setting_values.h"

namespace controlspace {
namespace {

constexpr auto number_type = ValueType::number;

const Setting<Study> table[] = {
    {"field_centre", number_type, 3, "", "x y z: centre of the field sphere [length]",
     [](Study& s, const SettingValues& v) { s.sources.field.centre = point(v); },
     [](const Study& s) { return coordinates(s.sources.field.centre); }},
    {"field_radius", number_type, 1, "", "Radius of the field sphere [length]",
     [](Study& s, const SettingValues& v) { s.sources.field.radius = positive(number(v.front())); },
     [](const Study& s) { return one(s.sources.field.radius); }},
    {"field_slope", number_type, 1, "",
     "Slope a of the second plane (u, -0.2 + a u, v) of the field planes",
     [](Study& s, const SettingValues& v) { s.sources.field.slope = number(v.front()); },
     [](const Study& s) { return one(s.sources.field.slope); }},
    {"field_lengths", number_type, 2, "",
     "Lengths across and along the surface of the field sphere or planes, there "
     "[length]",
     [](Study& s, const SettingValues& v) {
         if (v.size() != 2) throw InputError("give two numbers: across along");
         s.sources.field.lengths.across = positive(number(v[0]));
         s.sources.field.lengths.along = positive(number(v[1]));
     },
     [](const Study& s) {
         const SurfaceLengths& lengths = s.sources.field.lengths;
         return SettingValues{lengths.across, lengths.along};
     }},
    {"field_growth", number_type, 1, "",
     "How much those lengths grow with the distance from the surface [length / length]",
     [](Study& s, const SettingValues& v) {
         s.sources.field.lengths.growth = within(number(v.front()), 0, largest_magnitude);
     },
     [](const Study& s) { return one(s.sources.field.lengths.growth); }},
    {"field_largest", number_type, 1, "",
     "Length up to which they grow [length]; left out: half of the domain's diagonal, as anywhere",
     [](Study& s, const SettingValues& v) {
         s.sources.field.lengths.largest = positive(number(v.front()));
     },
     [](const Study& s) {
         const double largest = s.sources.field.lengths.largest;
         return largest == SurfaceLengths{}.largest ? SettingValues{} : one(largest);
     }},
};

}  // namespace

std::span<const Setting<Study>> field_settings() { return table; }

}  // namespace controlspace
