#pragma once

#include <span>

#include "study/settings.h"

namespace controlspace {

/// Keys of a study that concern .vdb files of sources and of fields; part of study_settings.
std::span<const Setting<Study>> vdb_settings();

}  // namespace controlspace
