#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace controlspace {

/// How a program that was run ended.
struct ChildOutcome {
    bool timed_out = false;  ///< and was killed
    int signal = 0;          ///< that ended it; 0: none
    int status = 0;          ///< where no signal ended it
    double processor_seconds = 0;
    std::size_t peak_bytes = 0;  ///< most memory that it held

    bool succeeded() const { return !timed_out && signal == 0 && status == 0; }
};

/// Runs the program `arguments[0]` in `folder`, with empty input and its output and errors in the
/// file `log`, and waits for it. It is killed after `time_limit_s`, with what it started
/// itself, and when the calling thread ends. Throws InputError if it cannot be started.
ChildOutcome run_child(const std::vector<std::string>& arguments,
                       const std::filesystem::path& folder, const std::filesystem::path& log,
                       double time_limit_s);

/// The last lines of a text file that are not blank, joined by " | ", for messages.
std::string last_lines(const std::filesystem::path& file, std::size_t count);

/// The path of `program` as a shell finds it: a name with a slash as it is, others in PATH; empty
/// if there is no such executable file.
std::filesystem::path find_program(const std::string& program);

}  // namespace controlspace
