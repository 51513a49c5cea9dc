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

namespace controlspace {

namespace fs = std::filesystem;

struct Outcome {
    int status = -1;
    std::string out;
    std::string err;
};

inline std::string file_text(const fs::path& path) {
    std::ostringstream text;
    text << std::ifstream(path).rdbuf();
    return text.str();
}

/// A folder of its own for each test, removed at the end.
class Sandbox {
public:
    explicit Sandbox(const std::string& name)
        : folder_(fs::temp_directory_path() / ("controlspace-app-" + name)) {
        fs::remove_all(folder_);
        fs::create_directories(folder_);
    }
    ~Sandbox() {
        std::error_code ignored;
        fs::remove_all(folder_, ignored);
    }
    Sandbox(const Sandbox&) = delete;
    Sandbox& operator=(const Sandbox&) = delete;

    fs::path operator/(const std::string& name) const { return folder_ / name; }

    void write(const std::string& name, const std::string& text) const {
        std::ofstream(folder_ / name) << text;
    }

    /// Runs `controlspace ARGUMENTS` in this folder, after `before` in the same shell.
    Outcome run(const std::string& arguments, const std::string& before = "") const {
        const std::string command = "cd '" + folder_.string() + "' || exit 9; " + before +
                                    "'" CONTROLSPACE_APP "' " + arguments + " >.out 2>.err";
        const int status = std::system(command.c_str());
        return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, file_text(folder_ / ".out"),
                file_text(folder_ / ".err")};
    }

private:
    fs::path folder_;
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
