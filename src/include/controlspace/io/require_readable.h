// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>

namespace controlspace {

/// Calls `read`, which reads `file`, in a child process first. OpenVDB, VTK, CGAL and Gmsh do
/// not validate files: a damaged one may crash them or exhaust memory. For files of unknown origin:
///
///     const auto read = [&] { return read_vdb_sources(file, surface); };
///     require_readable(file, read);
///     const auto sources = read();
///
/// The child has the memory and the time that a file of this size can justify. A crash ends it,
/// whatever handlers of signals the program has.
///
/// Throws InputError if the child crashes, needs more than that, or throws InputError (with its
/// text). `read` must not start threads, and its loops of TBB run on one; let no other thread of
/// the process hold a lock that `read` needs. On other systems than Linux `read` is called in this
/// process.
void require_readable(const std::filesystem::path& file, const std::function<void()>& read);

}  // namespace controlspace
