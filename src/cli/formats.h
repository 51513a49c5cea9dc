#pragma once

#include <string>

#include "controlspace/study/workload.h"

namespace controlspace {

/// Readers of files of sources and fields, of all formats beyond those of read_sources. Formats
/// that an external library reads need its module.
FileReaders file_readers();

/// The formats of sources, for help texts.
std::string source_formats_help();

}  // namespace controlspace
