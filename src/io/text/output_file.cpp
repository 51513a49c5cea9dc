#include "io/text/output_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <utility>

#include "controlspace/error.h"

namespace controlspace {

namespace {

// Through a symbolic link, so that renaming replaces the file and not the link.
std::filesystem::path without_links(const std::filesystem::path& path) {
    std::error_code ignored;
    const std::filesystem::path resolved = std::filesystem::weakly_canonical(path, ignored);
    return resolved.empty() ? path : resolved;
}

}  // namespace

std::filesystem::path OutputFile::partial(const std::filesystem::path& path) {
    return without_links(path) += fmt::format(".{}.partial", ::getpid());
}

OutputFile::OutputFile(const std::filesystem::path& path) {
    std::error_code ignored;
    if (std::filesystem::is_directory(path, ignored)) {
        throw InputError(
            fmt::format("cannot write {}: it is a directory, name a file", path.string()));
    }
    // A file that output is sent to may hold other things already.
    const bool standard_output = path == "/dev/stdout";
    const bool special = standard_output || (std::filesystem::exists(path, ignored) &&
                                             !std::filesystem::is_regular_file(path, ignored));
    target_ = special ? path : without_links(path);
    written_ = special ? path : partial(path);
    const int flags = O_WRONLY | O_CLOEXEC | (special ? 0 : O_CREAT | O_TRUNC);
    const int descriptor = standard_output ? ::fcntl(STDOUT_FILENO, F_DUPFD_CLOEXEC, 0)
                                           : ::open(written_.c_str(), flags, 0666);
    if (descriptor < 0) fail();
    file_ = ::fdopen(descriptor, "wb");
    if (file_ == nullptr) fail();
}

OutputFile::~OutputFile() {
    if (file_ != nullptr) std::fclose(file_);
    if (written_ != target_) {
        std::error_code ignored;
        std::filesystem::remove(written_, ignored);
    }
}

void OutputFile::write(std::string_view text) {
    if (std::fwrite(text.data(), 1, text.size(), file_) != text.size()) fail();
}

void OutputFile::commit() {
    std::FILE* file = std::exchange(file_, nullptr);
    // Some file systems report a full disk only when the file is closed.
    if (std::fclose(file) != 0) fail();
    if (written_ == target_) return;
    if (std::rename(written_.c_str(), target_.c_str()) != 0) fail();
    written_ = target_;
}

void OutputFile::fail() const {
    throw InputError(fmt::format("cannot write {}: {}", target_.string(), std::strerror(errno)));
}

}  // namespace controlspace
