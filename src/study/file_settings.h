#pragma once

#include <span>

#include "study/settings.h"

namespace controlspace {

/// Keys of a study that say how files of sources are read, but those of .vdb files; part of
/// study_settings.
std::span<const Setting<Study>> file_settings();

}  // namespace controlspace
