// SPDX-License-Identifier: Apache-2.0
#include "files/output_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <random>

#include "refuse.h"

namespace controlspace {

namespace {

// Through a symbolic link, so that renaming replaces the file and not the link.
std::filesystem::path without_links(const std::filesystem::path& path) {
    std::error_code ignored;
    const std::filesystem::path resolved = std::filesystem::weakly_canonical(path, ignored);
    return resolved.empty() ? path : resolved;
}

constexpr const char* standard_output = "/dev/stdout";

/// Written to directly. A file that standard output is sent to may hold other things already.
bool is_special(const std::filesystem::path& path) {
    std::error_code ignored;
    return path == standard_output || (std::filesystem::exists(path, ignored) &&
                                       !std::filesystem::is_regular_file(path, ignored));
}

/// Gives a new file the owner, as far as that is allowed, and the mode of the one that it replaces.
void keep_rights(int file, const struct stat& before) {
    [[maybe_unused]] const int ignored = ::fchown(file, before.st_uid, before.st_gid);
    ::fchmod(file, before.st_mode & 07777);
}

}  // namespace

void require_room(const std::filesystem::path& path, std::uintmax_t bytes) {
    std::error_code unknown;
    const std::filesystem::path target = without_links(path);
    if (std::filesystem::exists(target, unknown) &&
        !std::filesystem::is_regular_file(target, unknown)) {
        return;
    }
    const std::filesystem::path folder =
        target.has_parent_path() ? target.parent_path() : std::filesystem::path(".");
    const auto space = std::filesystem::space(folder, unknown);
    if (unknown || bytes <= space.available) return;
    constexpr double mb = 1e6;
    refuse("cannot write {}: it takes {:.1f} MB, and the disk has {:.1f} MB left", path.string(),
           static_cast<double>(bytes) / mb, static_cast<double>(space.available) / mb);
}

void require_writable(const std::filesystem::path& path) {
    std::error_code ignored;
    if (std::filesystem::is_directory(path, ignored)) {
        refuse("cannot write {}: it is a directory, name a file", path.string());
    }
    if (is_special(path)) return;
    const std::filesystem::path target = without_links(path);
    struct stat before {};
    if (::stat(target.c_str(), &before) == 0 &&
        ((before.st_mode & 0222) == 0 || ::access(target.c_str(), W_OK) != 0)) {
        refuse("cannot write {}: it is write-protected (chmod u+w), or name another file",
               path.string());
    }
    const std::filesystem::path folder = target.has_parent_path() ? target.parent_path() : ".";
    if (::access(folder.c_str(), W_OK | X_OK) != 0) {
        refuse("cannot write {}: {}", path.string(), std::strerror(errno));
    }
}

std::filesystem::path OutputFile::partial(const std::filesystem::path& path) {
    static const unsigned process = std::random_device{}();
    return without_links(path) += fmt::format(".{}.partial", process);
}

OutputFile::OutputFile(const std::filesystem::path& path) {
    require_writable(path);
    const bool special = is_special(path);
    target_ = special ? path : without_links(path);
    written_ = special ? path : partial(path);
    struct stat before {};
    const bool replaces = !special && ::stat(target_.c_str(), &before) == 0;
    file_ = path == standard_output ? stdout : std::fopen(written_.string().c_str(), "wb");
    if (file_ == nullptr) fail();
    if (replaces) keep_rights(::fileno(file_), before);
}

OutputFile::~OutputFile() {
    close();
    if (written_ != target_) {
        std::error_code ignored;
        std::filesystem::remove(written_, ignored);
    }
}

void OutputFile::write(std::string_view bytes) {
    if (bytes.empty()) return;  // they may be nowhere, which fwrite does not accept
    if (std::fwrite(bytes.data(), 1, bytes.size(), file_) != bytes.size()) fail();
}

bool OutputFile::close() {
    std::FILE* file = std::exchange(file_, nullptr);
    if (file == nullptr) return true;
    // Some file systems report a full disk only when the file is closed.
    return (file == stdout ? std::fflush(file) : std::fclose(file)) == 0;
}

void OutputFile::finish() {
    if (!close()) fail();
}

void OutputFile::commit() {
    finish();
    if (written_ == target_) return;
    sync();
    if (std::rename(written_.string().c_str(), target_.string().c_str()) != 0) fail();
    written_ = target_;
}

/// A crash of the system right after renaming must not leave an empty file.
void OutputFile::sync() const {
    const int file = ::open(written_.c_str(), O_RDONLY | O_CLOEXEC);
    if (file < 0) fail();
    const int error = ::fsync(file) == 0 ? 0 : errno;
    ::close(file);
    errno = error;
    if (error != 0 && error != EINVAL) fail();  // not all file systems can do it
}

void OutputFile::fail() const {
    refuse("cannot write {}: {}", target_.string(), std::strerror(errno));
}

}  // namespace controlspace
