#pragma once

#include <filesystem>
#include <functional>

namespace controlspace {

/// Calls `read`, which reads `file`, in a child process. Throws InputError if the child crashes,
/// needs far more memory or time than a file of this size can justify, or throws InputError: the
/// libraries that read other programs' formats trust their files, and may crash on damaged ones.
/// `read` must not start threads.
void require_readable(const std::filesystem::path& file, const std::function<void()>& read);

}  // namespace controlspace
