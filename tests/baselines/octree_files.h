// SPDX-License-Identifier: Apache-2.0
// What holds of every .vdb that a structure of OpenVDB with an octree is saved to.
#pragma once

#include <openvdb/io/File.h>
#include <openvdb/openvdb.h>

#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>
#include <string>

#include "baselines/fixtures.h"
#include "controlspace/space/control_space_file.h"
#include "damaged_copies.h"
#include "scratch_directory.h"
#include "sources/files.h"

namespace controlspace::octree_files {

/// What is said of a file of these bytes; "" if it is loaded.
inline std::string error_of_file(const std::filesystem::path& file, const std::string& bytes) {
    std::ofstream(file, std::ios::binary) << bytes;
    return error_of([&] { load_control_space(file, structures()); });
}

/// Damaged copies are refused in one line, which names the file.
inline void check_damaged_copies(const ControlSpace& space) {
    const ScratchDirectory folder;
    save_control_space(folder / "field.vdb", space);
    const std::string bytes = file_text(folder / "field.vdb");
    const int count = for_each_damaged_copy(bytes, 200, [&](const std::string& damaged) {
        if (damaged == bytes) return;
        REQUIRE_THAT(error_of_file(folder / "damaged.vdb", damaged),
                     Catch::Contains("damaged.vdb"));
    });
    CHECK(count > 200);
}

/// Grids that another program writes anew are a picture, no control space.
inline void check_is_picture(const openvdb::GridCPtrVec& grids) {
    const ScratchDirectory folder;
    const std::filesystem::path file = folder / "again.vdb";
    openvdb::io::File(file.string()).write(grids);
    CHECK_FALSE(holds_control_space(file));
    CHECK_THAT(error_of([&] { load_control_space(file, structures()); }),
               Catch::Contains("no control space"));
}

}  // namespace controlspace::octree_files
