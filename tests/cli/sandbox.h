// SPDX-License-Identifier: Apache-2.0
// Runs the program as a user does, in a folder of its own.
#pragma once

#include <sys/wait.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include "scratch_directory.h"

namespace controlspace {

namespace fs = std::filesystem;

struct Outcome {
    int status = -1;
    std::string out;
    std::string err;
};

/// A folder of its own for each test, removed at the end.
class Sandbox {
public:
    explicit Sandbox(const std::string& name) : folder_("app-" + name) {}

    fs::path operator/(const std::string& name) const { return folder_ / name; }

    void write(const std::string& name, const std::string& text) const { folder_.file(name, text); }

    /// Runs `controlspace ARGUMENTS` in this folder, after `before` in the same shell.
    Outcome run(const std::string& arguments, const std::string& before = "") const {
        const std::string command = "cd '" + folder_.path().string() + "' || exit 9; " + before +
                                    "'" CONTROLSPACE_APP "' " + arguments + " >.out 2>.err";
        const int status = std::system(command.c_str());
        return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, file_text(folder_ / ".out"),
                file_text(folder_ / ".err")};
    }

private:
    ScratchDirectory folder_;
};

inline std::size_t lines(const std::string& text) {
    return static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
}

inline void check_refused(const Outcome& outcome, const std::string& expected) {
    INFO(outcome.err);
    CHECK(outcome.status == 2);
    CHECK(lines(outcome.err) == 1);
    CHECK_THAT(outcome.err, Catch::Matchers::StartsWith("controlspace: error: "));
    CHECK_THAT(outcome.err, Catch::Matchers::Contains(expected));
    CHECK(outcome.out.empty());
}

}  // namespace controlspace
