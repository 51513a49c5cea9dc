// SPDX-License-Identifier: Apache-2.0
#include "controlspace/io/require_readable.h"

#include "files/text_file.h"

#ifdef __linux__

#include <fcntl.h>
#include <sys/resource.h>
#include <tbb/task_arena.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <optional>
#include <string>

#include "controlspace/error.h"
#include "files/child_process.h"
#include "io/text/metric_rows.h"
#include "refuse.h"

namespace controlspace {
namespace {

/// How the child ends: other numbers than those of libraries and sanitizers.
constexpr int readable = EXIT_SUCCESS, refused = 90, failed = 91;

/// Sanitizers reserve terabytes of addresses.
constexpr bool limits_memory =
#ifdef __SANITIZE_ADDRESS__
    false;
#else
    true;
#endif

void limit(int resource, rlim_t most) {
    const rlimit both{most, most};
    ::setrlimit(static_cast<__rlimit_resource>(resource), &both);
}

/// Limit of addresses for reading the file: what the program has mapped, and what the file can
/// justify.
rlim_t memory_limit(const std::filesystem::path& file) {
    constexpr rlim_t libraries = rlim_t{1} << 30;  // the stacks and heaps of threads among them
    constexpr rlim_t bytes_per_byte = 1000;
    std::size_t pages = 0;
    std::ifstream("/proc/self/statm") >> pages;
    std::error_code none;
    const auto size = std::filesystem::file_size(file, none);
    return pages * static_cast<rlim_t>(::sysconf(_SC_PAGESIZE)) + libraries +
           bytes_per_byte * (none ? 0 : size);
}

/// Limit of processor time for reading the file [s]: far more than the slowest reader takes.
unsigned time_limit(const std::filesystem::path& file) {
    constexpr std::uintmax_t bytes_per_second = 100'000;
    std::error_code none;
    const auto size = std::filesystem::file_size(file, none);
    return static_cast<unsigned>(20 + (none ? 0 : size) / bytes_per_second);
}

/// Crashes and limits end the process, whatever the program does on such signals: that may wait for
/// other threads, of which a child has none.
void end_on_crashes() {
    sigset_t signals;
    ::sigemptyset(&signals);
    for (const int signal :
         {SIGABRT, SIGALRM, SIGBUS, SIGFPE, SIGILL, SIGSEGV, SIGSYS, SIGTRAP, SIGXCPU}) {
        std::signal(signal, SIG_DFL);
        ::sigaddset(&signals, signal);
    }
    ::pthread_sigmask(SIG_UNBLOCK, &signals, nullptr);
}

[[noreturn]] void read_in_child(const std::filesystem::path& file,
                                const std::function<void()>& read, int answer) {
    end_on_crashes();
    // Libraries report crashes on standard error: not part of the program's output.
    const int nowhere = ::open("/dev/null", O_WRONLY | O_CLOEXEC);
    ::dup2(nowhere, STDOUT_FILENO);
    ::dup2(nowhere, STDERR_FILENO);
    limit(RLIMIT_CORE, 0);
    if (limits_memory) limit(RLIMIT_AS, memory_limit(file));
    limit(RLIMIT_CPU, time_limit(file));
    constexpr unsigned slowest = 10;  // times the processor's, where others use it too
    ::alarm(slowest * time_limit(file));
    int status = failed;
    try {
        read();
        status = readable;
    } catch (const IndefiniteTensors&) {
        status = readable;
    } catch (const InputError& error) {
        const std::string what = error.what();
        if (::write(answer, what.data(), what.size()) > 0) status = refused;
    } catch (...) {
    }
    std::_Exit(status);
}

std::string text_from(int descriptor) {
    std::string text;
    std::array<char, 4096> piece;
    for (ssize_t got = 1; got > 0 || (got < 0 && errno == EINTR);) {
        got = ::read(descriptor, piece.data(), piece.size());
        if (got > 0) text.append(piece.data(), static_cast<std::size_t>(got));
    }
    return text;
}

}  // namespace

void require_readable(const std::filesystem::path& file, const std::function<void()>& read) {
    require_no_stream(file);
    std::array<int, 2> ends{};
    if (::pipe2(ends.data(), O_CLOEXEC) != 0) {
        refuse_at(file, "no process can be started to read it: {}", std::strerror(errno));
    }
    // The child has none of the threads that TBB has started: in an arena of one thread, made
    // before, work neither waits for them nor for a lock that one of them holds.
    std::optional<ChildProcess> child;
    try {
        tbb::task_arena(1).execute(
            [&] { child.emplace([&] { read_in_child(file, read, ends[1]); }); });
    } catch (...) {
        ::close(ends[0]);
        ::close(ends[1]);
        throw;
    }
    ::close(ends[1]);
    const std::string answer = text_from(ends[0]);
    ::close(ends[0]);
    const ChildOutcome outcome = child->wait();
    if (outcome.succeeded()) return;
    if (outcome.signal == 0 && outcome.status == refused) throw InputError(answer);
    if (!outcome.is_known) {
        refuse_at(file,
                  "it cannot be known whether it is readable: the program that runs this one "
                  "collects its child processes");
    }
    refuse_at(file, "the library that reads such files fails on it: is it damaged, or cut off?");
}

}  // namespace controlspace

#else

namespace controlspace {

void require_readable(const std::filesystem::path& file, const std::function<void()>& read) {
    require_no_stream(file);
    read();
}

}  // namespace controlspace

#endif
