#pragma once

#include <filesystem>

#include "controlspace/fields/analytic_field.h"
#include "controlspace/fields/surface_fields.h"
#include "controlspace/io/read_vdb.h"

namespace controlspace {

/// Which analytic field a case has besides its point sources.
enum class FieldKind { none, sphere, planes, ugawg_linear, ugawg_polar_1, ugawg_polar_2, file };

/// An analytic field and its parameters (see fields/), or a .vdb file.
struct FieldChoice {
    FieldKind kind = FieldKind::none;
    Point centre = Point::Zero();  ///< sphere only
    double radius = 0.8;           ///< sphere only
    double slope = 0;              ///< planes only
    SurfaceLengths lengths = {};   ///< sphere and planes only
    std::filesystem::path file;    ///< file only, a .vdb
    VdbLengths vdb;                ///< file only

    bool operator==(const FieldChoice&) const = default;
};

/// Throws InputError for parameters out of range. `choice.kind` must be neither `none` nor `file`.
AnalyticField make_field(const FieldChoice& choice);

}  // namespace controlspace
