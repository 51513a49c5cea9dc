// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace controlspace {

/// Of files that read_sources reads.
inline constexpr std::array<std::string_view, 8> own_endings{".csv", ".npy",  ".mesh", ".meshb",
                                                             ".sol", ".solb", ".pos",  ".msh"};

// Endings of files that libraries read.

inline constexpr std::array<std::string_view, 4> vtk_endings{".vtu", ".vtp", ".vti", ".vtk"};
inline constexpr std::array<std::string_view, 4> triangle_endings{".stl", ".obj", ".ply", ".off"};
inline constexpr std::array<std::string_view, 5> cad_endings{".step", ".stp", ".iges", ".igs",
                                                             ".brep"};
inline constexpr std::array<std::string_view, 1> vdb_endings{".vdb"};

/// Files of surfaces and solids, the parts that are meshed.
inline const std::vector<std::string_view>& part_endings() {
    static const std::vector<std::string_view> all = [] {
        std::vector<std::string_view> endings(triangle_endings.begin(), triangle_endings.end());
        endings.insert(endings.end(), cad_endings.begin(), cad_endings.end());
        return endings;
    }();
    return all;
}

inline bool has_ending(std::span<const std::string_view> endings, const std::string& ending) {
    return std::ranges::count(endings, ending) > 0;
}

}  // namespace controlspace
