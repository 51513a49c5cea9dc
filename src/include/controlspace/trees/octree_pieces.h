// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <span>
#include <vector>

#include "controlspace/geometry/box.h"
#include "controlspace/space/catalogue.h"
#include "controlspace/space/control_space.h"

namespace controlspace {

// An octree in several files, as the ranks of an MPI job write it: an index (.pctrl) that names the
// pieces, control spaces (.ctrl) in the same folder. Each answers in some octants of the domain.
//
// The index is a text: a line "controlspace pieces 1"; a line with the domain, "x0,y0,z0,x1,y1,z1";
// and for each piece a line "piece NAME CHECKSUM", the last eight bytes of the file, followed by
// the boxes of its octants, a line each.

/// A piece, and the octants in which it answers.
struct OctreePiece {
    std::filesystem::path file;
    std::vector<Box> octants;
};

/// Writes the index of pieces that are there, whole or not at all. Throws InputError if it cannot.
void write_octree_pieces(const std::filesystem::path& index, const Box& domain,
                         std::span<const OctreePiece> pieces);

/// The control space of all pieces, to be read: in each octant its piece answers, the low side of
/// a face between two. Of a `region` only the pieces are loaded that answer in it, and the domain
/// is that part of the region: what a process needs to mesh its own subdomain. Throws InputError
/// if a file is missing, damaged or of another run, if the octants are not the leaves of one octree
/// over the domain, or if the region is outside the domain.
std::unique_ptr<ControlSpace> load_octree_pieces(const std::filesystem::path& index,
                                                 std::span<const CatalogueEntry> structures,
                                                 const Box& region = Box::everywhere());

}  // namespace controlspace
