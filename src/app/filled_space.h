#pragma once

#include <filesystem>
#include <memory>

#include "app/given_settings.h"
#include "spaces/control_space.h"

namespace controlspace {

/// Whether the file is a control space that was saved (.ctrl).
bool is_control_space(const std::filesystem::path& input);

/// Loads a control space that was saved. Throws InputError, also where settings are given: it is
/// as it is.
std::unique_ptr<ControlSpace> load_input(const std::filesystem::path& input,
                                         const GivenSettings& given);

/// The one structure that `input` (as study_of_input has it) and the settings ask for, made and
/// graded; or, of a .ctrl, loaded. Throws InputError.
std::unique_ptr<ControlSpace> filled_space(const std::filesystem::path& input,
                                           const GivenSettings& given);

}  // namespace controlspace
