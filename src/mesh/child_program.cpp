#include "mesh/child_program.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <deque>
#include <fstream>
#include <memory>
#include <thread>

#include "refuse.h"

namespace controlspace {
namespace {

namespace fs = std::filesystem;

constexpr int could_not_start = 127;

/// The child between fork and exec, where nothing but system calls may be made.
[[noreturn]] void become(char* const* arguments, const char* folder, int in, int out) {
    ::setpgid(0, 0);
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);
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

}  // namespace

ChildOutcome run_child(const std::vector<std::string>& arguments, const fs::path& folder,
                       const fs::path& log, double time_limit_s) {
    if (::access(arguments.front().c_str(), X_OK) != 0) {
        refuse("cannot run {}: {}", arguments.front(), std::strerror(errno));
    }
    const File in = opened("/dev/null", "r"), out = opened(log, "w");
    std::vector<char*> words;
    words.reserve(arguments.size() + 1);
    for (const std::string& word : arguments) words.push_back(const_cast<char*>(word.c_str()));
    words.push_back(nullptr);

    const pid_t child = ::fork();
    if (child < 0) refuse("cannot start {}: {}", arguments.front(), std::strerror(errno));
    if (child == 0) become(words.data(), folder.c_str(), ::fileno(in.get()), ::fileno(out.get()));

    using Clock = std::chrono::steady_clock;
    const auto start = Clock::now();
    ChildOutcome outcome;
    int state = 0;
    rusage usage{};
    while (::wait4(child, &state, WNOHANG, &usage) == 0) {
        const std::chrono::duration<double> elapsed = Clock::now() - start;
        if (elapsed.count() > time_limit_s) {
            outcome.timed_out = true;
            ::kill(-child, SIGKILL);
            ::kill(child, SIGKILL);  // it may not have become a group yet
            ::wait4(child, &state, 0, &usage);
            break;
        }
        constexpr std::chrono::milliseconds pause(5);
        std::this_thread::sleep_for(pause);
    }
    if (WIFSIGNALED(state)) outcome.signal = WTERMSIG(state);
    if (WIFEXITED(state)) outcome.status = WEXITSTATUS(state);
    outcome.processor_seconds = seconds_of(usage.ru_utime) + seconds_of(usage.ru_stime);
    outcome.peak_bytes = static_cast<std::size_t>(usage.ru_maxrss) * 1024;
    if (outcome.status == could_not_start && fs::is_empty(log)) {
        refuse("cannot run {}: is it a program of this system?", arguments.front());
    }
    return outcome;
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
