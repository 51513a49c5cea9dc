#pragma once

#include <filesystem>

#include "app/given_settings.h"

namespace controlspace {

/// What the command line of `info` asks for.
struct InfoOptions {
    std::filesystem::path input;  ///< file of sources
    GivenSettings settings;       ///< how it is read
};

/// Says on standard output what a file of sources holds. Throws InputError.
void info(const InfoOptions& options);

}  // namespace controlspace
