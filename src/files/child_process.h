// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>

#include <cstddef>
#include <filesystem>
#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <vector>

namespace controlspace {

/// How a child process ended.
struct ChildOutcome {
    bool is_known = false;   ///< false: another part of the program collected it first
    bool timed_out = false;  ///< and was killed
    int signal = 0;          ///< that ended it; 0: none
    int status = 0;          ///< where no signal ended it
    double processor_seconds = 0;
    std::size_t peak_bytes = 0;  ///< most memory that it held

    bool succeeded() const { return is_known && !timed_out && signal == 0 && status == 0; }
};

/// A child process. How it ends is known even where the program that started this one ignores
/// SIGCHLD, which an exec inherits and which makes the system forget children: the signal has its
/// default action while there is a ChildProcess.
class ChildProcess {
public:
    /// Forks. The child ends when this thread does; `body` must end it. Throws InputError if the
    /// system has no room for it.
    explicit ChildProcess(const std::function<void()>& body);
    /// Kills the child if it was not waited for.
    ~ChildProcess();
    ChildProcess(const ChildProcess&) = delete;
    ChildProcess& operator=(const ChildProcess&) = delete;

    /// Waits for its end; kills it after `time_limit_s`, with what it started in its group of
    /// processes if it leads one. To be called once.
    ChildOutcome wait(double time_limit_s = std::numeric_limits<double>::infinity());

private:
    const std::shared_ptr<void> kept_;  ///< SIGCHLD's action
    pid_t child_;                       ///< -1: waited for
};

/// Answers what a child process asks.
struct Conversation {
    std::size_t question_bytes, answer_bytes;
    std::function<void(const std::byte* question, std::byte* answer)> answer;
};

/// Runs the program `arguments[0]` in `folder`, with its output and errors in the file `log`, and
/// waits for it. Its standard input is empty, or a socket by which it may ask, one question after
/// the other. It is killed after `time_limit_s`, with what it started itself, and when the calling
/// thread ends. Throws InputError if it cannot be started; what `answer` throws passes through.
ChildOutcome run_child(const std::vector<std::string>& arguments,
                       const std::filesystem::path& folder, const std::filesystem::path& log,
                       double time_limit_s, const Conversation* conversation = nullptr);

/// A new folder in another one, removed with all that is in it unless it is to be kept.
class TemporaryFolder {
public:
    /// Its name begins with `name`. Throws InputError.
    TemporaryFolder(const std::filesystem::path& parent, const std::string& name);
    ~TemporaryFolder();
    TemporaryFolder(const TemporaryFolder&) = delete;
    TemporaryFolder& operator=(const TemporaryFolder&) = delete;

    const std::filesystem::path& path() const { return path_; }
    void keep() { keep_ = true; }

private:
    std::filesystem::path path_;
    bool keep_ = false;
};

/// The last lines of a text file that are not blank, joined by " | ", for messages.
std::string last_lines(const std::filesystem::path& file, std::size_t count);

/// The path of `program` as a shell finds it: a name with a slash as it is, others in PATH; empty
/// if there is no such executable file.
std::filesystem::path find_program(const std::string& program);

}  // namespace controlspace
