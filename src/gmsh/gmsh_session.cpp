// SPDX-License-Identifier: Apache-2.0
#include "gmsh/gmsh_session.h"

#include <fcntl.h>
#include <gmsh.h>
#include <unistd.h>

#include <algorithm>
#include <iostream>
#include <mutex>
#include <stdexcept>
#include <string>

#include "controlspace/error.h"

namespace controlspace {
namespace {

class GmshSession {
public:
    explicit GmshSession(int threads) {
        constexpr bool read_user_settings = false;
        gmsh::initialize(0, nullptr, read_user_settings);
        gmsh::option::setNumber("General.Terminal", 0);
        gmsh::option::setNumber("General.NumThreads", threads);
        gmsh::model::add("controlspace");
    }
    ~GmshSession() {
        try {
            gmsh::finalize();
        } catch (...) {  // nothing is left to do
        }
    }
    GmshSession(const GmshSession&) = delete;
    GmshSession& operator=(const GmshSession&) = delete;
};

/// OpenCASCADE reports on standard output: not part of the program's.
class SilentOutput {
public:
    SilentOutput() : before_(::dup(STDOUT_FILENO)) {
        std::cout.flush();
        const int nowhere = ::open("/dev/null", O_WRONLY | O_CLOEXEC);
        ::dup2(nowhere, STDOUT_FILENO);
        ::close(nowhere);
    }
    ~SilentOutput() {
        std::cout.flush();
        ::dup2(before_, STDOUT_FILENO);
        ::close(before_);
    }
    SilentOutput(const SilentOutput&) = delete;
    SilentOutput& operator=(const SilentOutput&) = delete;

private:
    int before_;
};

[[noreturn]] void fail(std::string what) {
    std::replace(what.begin(), what.end(), '\n', ' ');
    throw InputError("Gmsh failed: " + what);
}

}  // namespace

void in_gmsh_session(int threads, const std::function<void()>& action) {
    static std::mutex only_session;
    const std::lock_guard lock(only_session);
    try {
        const GmshSession session(threads);
        action();
    } catch (const std::string& what) {
        fail(what);
    } catch (int status) {
        fail("status " + std::to_string(status));
    } catch (const std::length_error&) {
        fail("it needs more memory than there is");
    }
}

std::vector<std::pair<int, int>> import_shapes(const std::filesystem::path& file) {
    const SilentOutput silent;
    std::vector<std::pair<int, int>> shapes;
    gmsh::model::occ::importShapes(file.string(), shapes);
    return shapes;
}

}  // namespace controlspace
