#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "controlspace/sources/point_source.h"
#include "study/file_readers.h"

namespace controlspace {

/// Readers of files of sources and fields, of all formats beyond those of read_sources. Formats
/// that an external library reads need its module.
FileReaders file_readers();

/// Writes `sources` in the format that the file's ending names. Throws InputError.
void write_source_file(const std::filesystem::path& file, std::span<const PointSource> sources);

/// The formats of sources, for help texts.
std::string source_formats_help();

}  // namespace controlspace
