// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "controlspace/space/control_space.h"
#include "mpi/exchange.h"
#include "mpi/octants.h"

namespace controlspace {

// A file of each rank and an index of them: see DistributedSpace::save and write_leaves. `own` is
// the field in this rank's octants. Collective; throw InputError on all ranks if a file cannot be
// written, and leave none.

void save_pieces(Ranks& ranks, const Octants& octants, const ControlSpace& own,
                 const std::filesystem::path& index);
void write_pieces_of_leaves(Ranks& ranks, const Octants& octants, const ControlSpace& own,
                            const std::filesystem::path& index);

}  // namespace controlspace
