#pragma once

#include <string>

namespace controlspace {

/// How lengths follow from the curvature of a surface: along each principal direction, the chord
/// that spans `angle` of the circle of curvature, within bounds.
struct CurvatureSizes {
    double angle = 15;  ///< [degrees]
    double h_min = 0;   ///< 0: a thousandth of the diagonal of the surface's box
    double h_max = 0;   ///< 0: a tenth of it

    bool operator==(const CurvatureSizes&) const = default;
};

/// What is taken out of a file of sources that holds more than one thing, or no lengths.
struct FileSources {
    std::string array = {};         ///< .vtu, .vtp, .msh; empty: the only one that can be meant
    CurvatureSizes curvature = {};  ///< .stl, .obj, .ply, .off

    bool operator==(const FileSources&) const = default;
};

}  // namespace controlspace
