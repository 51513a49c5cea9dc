// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "controlspace/mesh/part.h"
#include "controlspace/study/workload.h"
#include "io/surface/surface_mesh.h"
#include "io/surface/surface_sources.h"

namespace controlspace {

/// Readers of files of sources and fields, of all formats beyond those of read_sources. Formats
/// that an external library reads need its module.
FileReaders file_readers();

/// Whether a file holds a surface or a solid, by its ending.
bool is_part(const std::filesystem::path& file);

/// The surface of a part.
struct PartFacts {
    std::size_t triangles;
    SurfaceEdges edges;
    std::string unit;                ///< of a CAD file, as cad_unit has it
    std::vector<WallRequest> walls;  ///< by rays from random places, the same for the same file
};

/// `choice` is that which its sources were made by. Throws InputError.
PartFacts facts_of_part(const std::filesystem::path& file, const FileSources& choice,
                        std::size_t rays);

/// A part to be meshed, in the units of the field; `crease` as of Part. Throws InputError.
Part read_part(const std::filesystem::path& file, double crease, const FileSources& choice);

/// The formats of sources, for help texts.
std::string source_formats_help();

}  // namespace controlspace
