// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

namespace controlspace {

/// Baked in when the program is built (build_info.cmake).
struct BuildInfo {
    std::string_view version;
    std::string_view commit;
    bool dirty;
    std::string_view compiler;
    std::string_view flags;
};
extern const BuildInfo build_info;

}  // namespace controlspace
