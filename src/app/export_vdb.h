#pragma once

#include <string>

#include "app/export.h"
#include "study/run.h"

namespace controlspace {

/// What a structure was made for.
struct Origin {
    const Study& study;
    const Case& c;
    const Workload& workload;
};

/// Writes the field of `space` to a .vdb; says what was written. Without an `origin`, that of a
/// control space that was loaded. Throws InputError.
std::string export_vdb(const ExportOptions& options, const ControlSpace& space,
                       const Origin* origin);

}  // namespace controlspace
