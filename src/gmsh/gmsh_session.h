// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <utility>
#include <vector>

namespace controlspace {

/// Runs `action` with Gmsh open, without the user's own settings, on an empty model. Gmsh is one
/// for the whole process: a second session waits for the end of the first. What Gmsh throws, texts
/// and numbers, becomes InputError "Gmsh failed: what" on one line.
void in_gmsh_session(int threads, const std::function<void()>& action);

/// Shapes of a CAD file, dimensions and tags, in the model of a session. What OpenCASCADE reports
/// is not shown.
std::vector<std::pair<int, int>> import_shapes(const std::filesystem::path& file);

}  // namespace controlspace
