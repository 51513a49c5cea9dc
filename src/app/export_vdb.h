#pragma once

#include <string>

#include "app/export.h"
#include "study/run.h"

namespace controlspace {

/// Writes the field of `space`, made for the case `c`, to a .vdb; says what was written.
std::string export_vdb(const ExportOptions& options, const Study& study, const Case& c,
                       const Workload& workload, const ControlSpace& space);

}  // namespace controlspace
