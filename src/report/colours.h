#pragma once

#include <string_view>

namespace controlspace {

/// gnuplot's commands for colour scales that rise in lightness evenly and are read by all kinds of
/// colour vision: places of Smith and van der Walt's viridis and, from light to dark,
/// inferno.
constexpr std::string_view viridis_palette =
    "set palette defined (0 '#440154', 1 '#472c7a', 2 '#3b518b', 3 '#2c718e', 4 '#21908d', "
    "5 '#27ad81', 6 '#5cc863', 7 '#aadc32', 8 '#fde725')\n";
constexpr std::string_view error_palette =
    "set palette defined (0 '#fcffa4', 1 '#fac127', 2 '#f57d15', 3 '#d44842', 4 '#9f2a63', "
    "5 '#65156e', 6 '#280b54', 7 '#000004')\n";

}  // namespace controlspace
