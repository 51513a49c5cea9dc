#include "gmsh/gmsh_session.h"

#include <gmsh.h>

#include <algorithm>

namespace controlspace {
namespace {

std::mutex& only_session() {
    static std::mutex mutex;
    return mutex;
}

}  // namespace

GmshSession::GmshSession(int threads) : lock_(only_session()) {
    constexpr bool read_user_settings = false;
    gmsh::initialize(0, nullptr, read_user_settings);
    gmsh::option::setNumber("General.Terminal", 0);
    gmsh::option::setNumber("General.NumThreads", threads);
    gmsh::model::add("controlspace");
}

GmshSession::~GmshSession() {
    try {
        gmsh::finalize();
    } catch (...) {  // nothing is left to do
    }
}

InputError gmsh_failure(std::string what) {
    std::replace(what.begin(), what.end(), '\n', ' ');
    return InputError("Gmsh failed: " + what);
}

}  // namespace controlspace
