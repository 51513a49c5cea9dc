// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "controlspace/space/catalogue.h"
#include "controlspace/space/control_space.h"
#include "controlspace/space/control_space_builder.h"

namespace controlspace {

// A file of a control space (.ctrl), all numbers little-endian:
//   8 bytes    89 43 54 52 4c 0d 0a 1a
//   32 bits    version of the format
//   32 bits    01020304 (hexadecimal), by which the order of bytes can be seen
//   64 bits    size of the file in bytes
//   ...        named arrays of numbers, each in chunks that Blosc has compressed (state.h)
//   64 bits    checksum of all bytes before: XXH3

/// Version of the format that is written. Format 5 is read, too.
inline constexpr std::uint32_t control_space_file_version = 6;

/// How a structure was made.
struct Recipe {
    std::string structure;  ///< id in the catalogue
    SpaceOptions options;
    std::optional<Precision> precision = {};  ///< of the compact form
};

/// None where it was not made by a CatalogueEntry.
std::optional<Recipe> recipe_of(const ControlSpace& space);

/// Whether a file is a control space by its ending, .ctrl, or a .vdb that holds one.
bool holds_control_space(const std::filesystem::path& file);

/// Writes a finished structure, or a builder, which can be continued after loading, to `file`:
/// whole or not at all. Throws InputError where it was not made by a
/// CatalogueEntry, where it keeps a continuous field, and where writing fails.
///
/// Where the file ends in .vdb, OpenVDB's, the lengths of a structure with VdbFiles, finished, are
/// written in floats, as other programs read them: of openvdb-tiles a FloatGrid `length`, whose
/// active tiles and voxels are the structure's; of openvdb-bricks a FloatGrid for each level of
/// its octree with bricks, `length_0` (the root's), `length_1` and so on, of their vertices. What
/// is loaded answers these floats, to the bit, whatever precision was saved; where bricks in codes
/// meet, which each round for themselves, those of one of them. A file that another program has
/// written anew holds no control space any more.
void save_control_space(const std::filesystem::path& file, const ControlSpace& space);
void save_control_space(const std::filesystem::path& file, const ControlSpaceBuilder& builder);

/// What a file holds.
struct SavedControlSpace {
    Recipe recipe;
    std::string saved_by;                          ///< "controlspace 0.1.0, format 5"
    std::unique_ptr<ControlSpaceBuilder> builder;  ///< none of a compact form
    std::unique_ptr<ControlSpace> space;
};

/// The control space that was saved: it answers, takes sources and is graded as the first one
/// would, to the last bit, in as much memory.
/// Throws InputError with the reason if the file is missing, is not a control space, has another
/// format version, is truncated or altered, or if its structure is not among `structures`.
SavedControlSpace open_control_space(const std::filesystem::path& file,
                                     std::span<const CatalogueEntry> structures);
/// The space alone, to be read.
std::unique_ptr<ControlSpace> load_control_space(const std::filesystem::path& file,
                                                 std::span<const CatalogueEntry> structures);
/// The builder alone. Throws InputError for a compact form, too.
std::unique_ptr<ControlSpaceBuilder> load_builder(const std::filesystem::path& file,
                                                  std::span<const CatalogueEntry> structures);

}  // namespace controlspace
