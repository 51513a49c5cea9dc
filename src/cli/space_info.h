#pragma once

#include <filesystem>
#include <string>

namespace controlspace {

/// What `info` says of a control space that was saved: its structure and options, its parts and
/// what they take, and the range of what its control nodes ask for. Throws InputError.
std::string space_info(const std::filesystem::path& file);

}  // namespace controlspace
