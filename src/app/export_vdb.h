#pragma once

#include <string>

#include "app/export.h"
#include "app/filled_space.h"
#include "app/step_progress.h"

namespace controlspace {

/// Writes the field of a structure to a .vdb; says what was written. Throws InputError.
std::string export_vdb(const ExportOptions& options, const FilledSpace& filled,
                       StepProgress& progress);

}  // namespace controlspace
