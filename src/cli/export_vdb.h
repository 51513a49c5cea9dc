#pragma once

#include <string>

#include "cli/export.h"
#include "cli/filled_space.h"
#include "cli/step_progress.h"

namespace controlspace {

/// Writes the field of a structure to a .vdb; says what was written. Throws InputError.
std::string export_vdb(const ExportOptions& options, const FilledSpace& filled,
                       StepProgress& progress);

}  // namespace controlspace
