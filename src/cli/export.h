// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "cli/filled_space.h"
#include "cli/options.h"
#include "cli/progress.h"

namespace controlspace {

/// A field to be written to a file.
struct Export {
    const std::filesystem::path& input;  ///< as of filled_space
    const std::filesystem::path& output;
    const std::string& command_line;
    const FilledSpace& filled;
    StepProgress& progress;
    std::optional<int> samples;  ///< along the longest edge, as given by --samples
};

/// A format of files of fields.
struct FieldFormat {
    std::vector<std::string> endings;
    /// Writes the file, and returns what was written, for standard output.
    std::function<std::string(const Export&)> write;
    /// Of its options in the help; they are refused with formats that do not have the group.
    std::vector<std::string> groups = {};
    /// Throws InputError where the file or its options cannot be used, before anything is built.
    std::function<void(const std::filesystem::path& output, std::optional<int> samples)> check =
        [](const auto&, const auto&) {};
};

/// The group of --samples, the option of all formats that are sampled in equal steps.
inline constexpr const char* samples_group = "A .vti, .npy, .nc, .structured or .msh file";

/// Of grids, where it is not given.
inline constexpr int grid_samples = 129;

// Each adds the options of some formats to the command, and returns the formats.
std::vector<FieldFormat> add_size_formats(Options& options);
std::vector<FieldFormat> add_text_formats(Options& options);
std::vector<FieldFormat> add_vdb_formats(Options& options);
std::vector<FieldFormat> add_vtk_formats(Options& options);

/// "FILE: `what`; 1.2 MB", and a line end.
std::string written(const Export& e, const std::string& what,
                    std::span<const std::filesystem::path> files = {});

}  // namespace controlspace
