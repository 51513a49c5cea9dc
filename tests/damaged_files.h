#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>

namespace controlspace {

/// Calls `read` with copies of the file `name` that are cut off, have bytes flipped, numbers
/// replaced by others that lie, and pieces lost or doubled, the same in every run; other files that
/// it needs lie in `folder` already. CHECKs that each ends in an answer or in an InputError of one
/// line, and that no more than `bytes_per_byte` of the file, and some 100 kB, were allocated.
///
/// The environment variable DAMAGED_FILES multiplies their number. A program that uses this links
/// counting_allocator.cpp.
void check_damaged_files(const std::filesystem::path& folder, const std::string& name,
                         const std::string& bytes, std::size_t bytes_per_byte,
                         const std::function<void(const std::filesystem::path&)>& read);

}  // namespace controlspace
