#pragma once

#include <filesystem>
#include <string>

#include "cli/given_settings.h"
#include "measure/source_summary.h"

namespace controlspace {

/// What the command line of `info` asks for.
struct InfoOptions {
    std::filesystem::path input;  ///< file of sources, or a control space that was saved
    GivenSettings settings;       ///< how sources are read
};

/// Says on standard output what a file of sources, or of a control space, holds. Tensors that are
/// not positive definite are counted, where all other commands refuse them. Throws InputError where
/// the file cannot be read.
void info(const InfoOptions& options);

/// Lines on how many metrics are isotropic, and on the range of lengths and anisotropy.
std::string lengths_text(const LengthSummary& lengths);

}  // namespace controlspace
