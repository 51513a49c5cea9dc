// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "cli/folder_lock.h"
#include "cli/signals.h"
#include "controlspace/geometry/box.h"
#include "controlspace/space/control_space.h"
#include "controlspace/study/provenance.h"
#include "controlspace/study/study.h"
#include "study/mesh_rows.h"
#include "study/mesh_settings.h"

namespace controlspace {

/// Makes meshes one after the other into a folder of results, whose meshes.json is kept up to date.
class MeshFolder {
public:
    /// The folder is that of the study; it is not made yet. Progress goes to standard error unless
    /// `quiet`.
    MeshFolder(const Study& study, MeshSettings settings, const std::string& command_line,
               bool quiet, Interruption& interruption);

    /// Makes the folder. Throws InputError.
    void begin();
    /// Meshes the box by the row's mesher, measures how the mesh conforms to `reference`, and
    /// writes both. `field` returns the field to be meshed, which must live as long as itself, and
    /// may enter the times into the row; without it `reference` is meshed. Errors are entered into
    /// the row.
    void add(MeshRow row, const Box& domain, const ControlSpace& reference,
             const std::function<const ControlSpace&(MeshRow&)>& field = {});
    /// Marks the results as complete.
    void end();

    /// Removes what meshers that are interrupted leave.
    void remove_files_of_meshers() const;

    const MeshSettings& settings() const { return settings_; }
    const std::filesystem::path& path() const { return path_; }
    const std::vector<MeshRow>& rows() const { return rows_; }

private:
    void record(bool complete) const;

    Study study_;
    MeshSettings settings_;
    bool quiet_;
    Interruption& interruption_;
    Provenance provenance_;
    std::filesystem::path path_;
    std::optional<FolderLock> lock_;
    std::vector<MeshRow> rows_;
};

}  // namespace controlspace
