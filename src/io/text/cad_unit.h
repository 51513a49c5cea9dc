// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

namespace controlspace {

/// The unit of length that a .step or .iges file says that its numbers are in: "mm", "m", "in";
/// several are joined by " and ". Empty where it says none, as a .brep, or is no such file.
std::string cad_unit(const std::filesystem::path& file);

}  // namespace controlspace
