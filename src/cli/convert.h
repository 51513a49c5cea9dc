#pragma once

#include <filesystem>

#include "cli/given_settings.h"

namespace controlspace {

/// What the command line of `convert` asks for.
struct ConvertOptions {
    std::filesystem::path input;   ///< file of sources
    std::filesystem::path output;  ///< its ending says the format
    GivenSettings settings;        ///< how the input is read
};

/// Writes the sources of one file in another format. Throws InputError.
void convert(const ConvertOptions& options);

}  // namespace controlspace
