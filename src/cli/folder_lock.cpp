// SPDX-License-Identifier: Apache-2.0
#include "cli/folder_lock.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>

#include "refuse.h"

namespace controlspace {

FolderLock::FolderLock(const std::filesystem::path& folder, bool make) {
    std::error_code ignored;
    if (make) std::filesystem::create_directories(folder, ignored);
    descriptor_ = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (descriptor_ < 0 || ::flock(descriptor_, LOCK_EX | LOCK_NB) == 0) return;
    if (errno != EWOULDBLOCK) return;  // a file system without locks
    ::close(descriptor_);
    refuse_at(folder,
              "another run writes its results there: wait for it, or choose another output folder");
}

FolderLock::~FolderLock() {
    if (descriptor_ >= 0) ::close(descriptor_);
}

}  // namespace controlspace
