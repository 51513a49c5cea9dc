#pragma once

#include <mutex>
#include <stdexcept>
#include <string>

#include "controlspace/error.h"

namespace controlspace {

/// Gmsh's numbers of kinds of elements.
inline constexpr int gmsh_triangle = 2;
inline constexpr int gmsh_tetrahedron = 4;

/// Gmsh, opened without the user's own settings and closed again. It is one for the whole process:
/// a second session waits for the end of the first.
class GmshSession {
public:
    explicit GmshSession(int threads);
    ~GmshSession();
    GmshSession(const GmshSession&) = delete;
    GmshSession& operator=(const GmshSession&) = delete;

private:
    std::unique_lock<std::mutex> lock_;
};

/// "Gmsh failed: `what`", on one line.
InputError gmsh_failure(std::string what);

/// Runs `action` in a session; what Gmsh throws, texts and numbers, becomes InputError.
template <class Action>
auto in_gmsh_session(int threads, Action&& action) {
    try {
        const GmshSession session(threads);
        return action();
    } catch (const std::string& what) {
        throw gmsh_failure(what);
    } catch (int status) {
        throw gmsh_failure("status " + std::to_string(status));
    } catch (const std::length_error&) {
        throw gmsh_failure("it was asked for more than memory holds");
    }
}

}  // namespace controlspace
