// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

namespace controlspace {

/// Keeps other runs of the program out of a folder of results while it lives, also if they run on
/// other machines where the file system allows for that. Ends with the program, however that ends.
class FolderLock {
public:
    /// Throws InputError if another run has the folder. `make`: makes it first, with its parents.
    /// That it is not there, or cannot be made, is no error here.
    FolderLock(const std::filesystem::path& folder, bool make);
    ~FolderLock();
    FolderLock(const FolderLock&) = delete;
    FolderLock& operator=(const FolderLock&) = delete;

private:
    int descriptor_;  ///< negative where the folder could not be opened
};

}  // namespace controlspace
