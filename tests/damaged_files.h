// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>

namespace controlspace {

/// Calls `read` with the damaged copies of the file `name`; other files that it needs lie in
/// `folder` already. CHECKs that each ends in an answer or in an InputError of one line, and that
/// no more than `bytes_per_byte` of the file, and some 100 kB, were allocated: a program that uses
/// this links counting_allocator.cpp.
void check_damaged_files(const std::filesystem::path& folder, const std::string& name,
                         const std::string& bytes, std::size_t bytes_per_byte,
                         const std::function<void(const std::filesystem::path&)>& read);

}  // namespace controlspace
