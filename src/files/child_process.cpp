// SPDX-License-Identifier: Apache-2.0
#include "files/child_process.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <stdlib.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#ifdef __linux__
#include <sys/prctl.h>
#endif

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <deque>
#include <fstream>
#include <memory>
#include <mutex>
#include <thread>
#include <utility>

#include "refuse.h"

namespace controlspace {
namespace {

namespace fs = std::filesystem;

constexpr int could_not_start = 127;

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

/// Gives SIGCHLD its default action while an object of this type exists, if children would be
/// forgotten otherwise.
class KeptChildren {
public:
    KeptChildren() {
        const std::lock_guard lock(mutex);
        if (++count > 1) return;
        ::sigaction(SIGCHLD, nullptr, &before);
        forgets = before.sa_handler == SIG_IGN || (before.sa_flags & SA_NOCLDWAIT) != 0;
        if (forgets) std::signal(SIGCHLD, SIG_DFL);
    }
    ~KeptChildren() {
        const std::lock_guard lock(mutex);
        if (--count == 0 && forgets) ::sigaction(SIGCHLD, &before, nullptr);
    }
    KeptChildren(const KeptChildren&) = delete;
    KeptChildren& operator=(const KeptChildren&) = delete;

private:
    static inline std::mutex mutex;
    static inline int count = 0;
    static inline bool forgets = false;
    static inline struct sigaction before {};
};

/// The child between fork and exec, where nothing but system calls may be made.
[[noreturn]] void become(char* const* arguments, const char* folder, int in, int out) {
    ::setpgid(0, 0);
    // This program may hold signals back; the other one must not.
    sigset_t none;
    sigemptyset(&none);
    ::sigprocmask(SIG_SETMASK, &none, nullptr);
    const bool ready = ::dup2(in, STDIN_FILENO) >= 0 && ::dup2(out, STDOUT_FILENO) >= 0 &&
                       ::dup2(out, STDERR_FILENO) >= 0 && ::chdir(folder) == 0;
    if (ready) ::execv(arguments[0], arguments);
    ::_exit(could_not_start);
}

double seconds_of(const timeval& time) {
    return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
}

using File = std::unique_ptr<std::FILE, int (*)(std::FILE*)>;

/// In a mode of fopen; closed in programs that are run.
File opened(const fs::path& path, const std::string& mode) {
    File file(std::fopen(path.c_str(), (mode + "e").c_str()), std::fclose);
    if (file) return file;
    refuse("cannot open {}: {}", path.string(), std::strerror(errno));
}

/// The standard input of a child: nothing, or one end of a socket.
struct Input {
    explicit Input(bool is_socket) {
        if (!is_socket) {
            of_child = ::open("/dev/null", O_RDONLY | O_CLOEXEC);
        } else if (std::array<int, 2> ends{};
                   ::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()) == 0) {
            of_child = ends[0];
            socket = ends[1];
        }
        if (of_child < 0) refuse("cannot start a process: {}", std::strerror(errno));
    }
    ~Input() {
        for (const int descriptor : {of_child, socket}) {
            if (descriptor >= 0) ::close(descriptor);
        }
    }
    Input(const Input&) = delete;
    Input& operator=(const Input&) = delete;

    mutable int of_child = -1;  ///< -1: closed
    int socket = -1;
};

/// Answers until the child has closed its end, or its time is over.
void converse(int socket, const Conversation& conversation, Clock::time_point start,
              double time_limit_s) {
    std::vector<std::byte> question(conversation.question_bytes);
    std::vector<std::byte> answer(conversation.answer_bytes);
    constexpr timeval pause{.tv_sec = 0, .tv_usec = 100'000};  // between looks at the clock
    ::setsockopt(socket, SOL_SOCKET, SO_RCVTIMEO, &pause, sizeof pause);
    for (std::size_t got = 0; seconds_since(start) < time_limit_s;) {
        const ssize_t more = ::recv(socket, question.data() + got, question.size() - got, 0);
        if (more < 0 && (errno == EINTR || errno == EAGAIN)) continue;
        if (more <= 0) return;
        got += static_cast<std::size_t>(more);
        if (got < question.size()) continue;
        got = 0;
        conversation.answer(question.data(), answer.data());
        // Shorter than the buffer of the socket, which is empty: sent at once.
        if (::send(socket, answer.data(), answer.size(), MSG_NOSIGNAL) < 0) return;
    }
}

}  // namespace

ChildProcess::ChildProcess(const std::function<void()>& body)
    : kept_(std::make_shared<KeptChildren>()), child_(::fork()) {
    if (child_ < 0) refuse("cannot start a process: {}", std::strerror(errno));
    if (child_ > 0) return;
#ifdef __linux__
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);
#endif
    body();
    ::_exit(could_not_start);
}

ChildProcess::~ChildProcess() {
    if (child_ > 0) wait(0);
}

ChildOutcome ChildProcess::wait(double time_limit_s) {
    const auto start = Clock::now();
    const pid_t child = std::exchange(child_, -1);
    ChildOutcome outcome;
    int state = 0;
    rusage usage{};
    pid_t ended = 0;
    const auto collect = [&](int how) {
        do {
            ended = ::wait4(child, &state, how, &usage);
        } while (ended < 0 && errno == EINTR);
        return ended;
    };
    while (collect(std::isinf(time_limit_s) ? 0 : WNOHANG) == 0) {
        if (seconds_since(start) >= time_limit_s) {
            outcome.timed_out = true;
            ::kill(-child, SIGKILL);
            ::kill(child, SIGKILL);  // it may lead no group
            collect(0);
            break;
        }
        constexpr std::chrono::milliseconds pause(5);
        std::this_thread::sleep_for(pause);
    }
    outcome.is_known = ended == child;
    if (WIFSIGNALED(state)) outcome.signal = WTERMSIG(state);
    if (WIFEXITED(state)) outcome.status = WEXITSTATUS(state);
    outcome.processor_seconds = seconds_of(usage.ru_utime) + seconds_of(usage.ru_stime);
    outcome.peak_bytes = static_cast<std::size_t>(usage.ru_maxrss) * 1024;
    return outcome;
}

ChildOutcome run_child(const std::vector<std::string>& arguments, const fs::path& folder,
                       const fs::path& log, double time_limit_s, const Conversation* conversation) {
    if (::access(arguments.front().c_str(), X_OK) != 0) {
        refuse("cannot run {}: {}", arguments.front(), std::strerror(errno));
    }
    const File out = opened(log, "w");
    const Input input(conversation != nullptr);
    std::vector<char*> words;
    words.reserve(arguments.size() + 1);
    for (const std::string& word : arguments) words.push_back(const_cast<char*>(word.c_str()));
    words.push_back(nullptr);

    const auto start = Clock::now();
    ChildProcess child(
        [&] { become(words.data(), folder.c_str(), input.of_child, ::fileno(out.get())); });
    ::close(std::exchange(input.of_child, -1));
    if (conversation != nullptr) converse(input.socket, *conversation, start, time_limit_s);
    const ChildOutcome outcome = child.wait(std::max(0.0, time_limit_s - seconds_since(start)));
    if (outcome.status == could_not_start && fs::is_empty(log)) {
        refuse("cannot run {}: is it a program of this system?", arguments.front());
    }
    return outcome;
}

TemporaryFolder::TemporaryFolder(const fs::path& parent, const std::string& name) {
    std::string pattern = (parent / (name + "-XXXXXX")).string();
    if (::mkdtemp(pattern.data()) == nullptr) {
        refuse("cannot make a folder in {}: {}", parent.string(), std::strerror(errno));
    }
    path_ = fs::absolute(pattern);
}

TemporaryFolder::~TemporaryFolder() {
    std::error_code ignored;
    if (!keep_) fs::remove_all(path_, ignored);
}

std::string last_lines(const fs::path& file, std::size_t count) {
    std::ifstream text(file);
    std::deque<std::string> lines;
    for (std::string line; std::getline(text, line);) {
        const auto first = line.find_first_not_of(" \t\r");
        if (first == std::string::npos) continue;
        lines.push_back(line.substr(first, line.find_last_not_of(" \t\r") + 1 - first));
        if (lines.size() > count) lines.pop_front();
    }
    return fmt::format("{}", fmt::join(lines, " | "));
}

fs::path find_program(const std::string& program) {
    const auto is_program = [](const fs::path& path) {
        std::error_code ignored;
        return fs::is_regular_file(path, ignored) && ::access(path.c_str(), X_OK) == 0;
    };
    if (program.find('/') != std::string::npos) {
        return is_program(program) ? fs::absolute(program) : fs::path();
    }
    const char* variable = std::getenv("PATH");
    std::string_view folders = variable == nullptr ? "" : variable;
    while (!folders.empty()) {
        const auto colon = folders.find(':');
        const fs::path candidate = fs::path(folders.substr(0, colon)) / program;
        if (is_program(candidate)) return fs::absolute(candidate);
        folders = colon == std::string_view::npos ? "" : folders.substr(colon + 1);
    }
    return {};
}

}  // namespace controlspace
