#pragma once

#include <span>

#include "study/settings.h"

namespace controlspace {

/// Keys of a study that concern its analytic fields; part of study_settings.
std::span<const Setting<Study>> field_settings();

}  // namespace controlspace
