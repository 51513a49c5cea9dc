#pragma once

#include <filesystem>
#include <functional>

namespace controlspace {

/// Reads `file` in a process of its own first, by `read`, and throws InputError if that does not
/// outlive it, takes far more memory or time than the file could fill, or refuses it: the libraries
/// that read other programs' formats trust what a file says, and may crash where it is damaged.
/// What `read` starts must not outlive it.
void require_readable(const std::filesystem::path& file, const std::function<void()>& read);

}  // namespace controlspace
