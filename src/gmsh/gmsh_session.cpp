#include "gmsh/gmsh_session.h"

#include <gmsh.h>

#include <algorithm>
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

}  // namespace controlspace
