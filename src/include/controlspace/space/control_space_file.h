#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>

#include "controlspace/space/catalogue.h"
#include "controlspace/space/control_space.h"

namespace controlspace {

// A file of a control space (.ctrl), all numbers little-endian:
//   8 bytes    89 43 54 52 4c 0d 0a 1a
//   32 bits    version of the format: 2
//   32 bits    01020304 (hexadecimal), by which the order of bytes can be seen
//   64 bits    size of the file in bytes
//   ...        named arrays of numbers, each in chunks that Blosc has compressed (state.h)
//   64 bits    checksum of all bytes before: XXH3

/// Version of the format that is written, and the only one that is read: version 1, whose checksum
/// was another, was never released.
inline constexpr std::uint32_t control_space_file_version = 2;

/// Writes `space`, with all that it takes to go on with it, to `file`: whole or not at all. Throws
/// InputError where it was not made by a CatalogueEntry, where it keeps a continuous field, and
/// where writing fails.
void save_control_space(const std::filesystem::path& file, const ControlSpace& space);

/// The control space that was saved: it answers, takes sources and is graded as the first one
/// would, to the last bit, in as much memory.
/// Throws InputError, saying why, where the file is missing, no such file, of a newer version,
/// truncated or altered, and where its structure is not among `structures`.
std::unique_ptr<ControlSpace> load_control_space(const std::filesystem::path& file,
                                                 std::span<const CatalogueEntry> structures);

}  // namespace controlspace
