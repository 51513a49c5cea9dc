#pragma once

#include <fmt/format.h>

#include <string>

#include "controlspace/error.h"
#include "study/settings.h"

namespace controlspace {

// What the tables of settings are written with.

inline double number(const SettingValue& value) { return std::get<double>(value); }
inline const std::string& text(const SettingValue& value) { return std::get<std::string>(value); }

/// `value`, if it is from `least` to `most`.
inline double within(double value, double least, double most) {
    if (value < least || value > most) {
        throw InputError(fmt::format("{} is out of range: give {} to {}", value, least, most));
    }
    return value;
}

inline double positive(double value) {
    if (!(value > 0)) throw InputError(fmt::format("{} is not positive", value));
    return value;
}

inline SettingValues one(double value) { return {value}; }

inline Point point(const SettingValues& values) {
    if (values.size() != 3) throw InputError("give three numbers: x y z");
    return {number(values[0]), number(values[1]), number(values[2])};
}
inline SettingValues coordinates(const Point& p) { return {p.x(), p.y(), p.z()}; }

}  // namespace controlspace
