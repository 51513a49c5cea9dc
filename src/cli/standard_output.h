// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string_view>

namespace controlspace {

/// Occupies descriptors 0 to 2 if the caller closed them, so that files opened later cannot get
/// these numbers. Writing there still fails. To be called first.
void occupy_standard_descriptors();

/// Writes `text` to standard output. Throws InputError if that fails (a full disk).
void print(std::string_view text);

/// The same to a file, or to standard output (/dev/stdout).
void print_to(const std::filesystem::path& output, std::string_view text);

/// Writes `text` to standard error. Failures are ignored.
void print_error(std::string_view text);

}  // namespace controlspace
