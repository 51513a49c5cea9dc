// SPDX-License-Identifier: Apache-2.0
// Files of many ranks.
#define OMPI_SKIP_MPICXX 1
#define MPICH_SKIP_MPICXX 1
#include "mpi/pieces.h"

#include <fmt/format.h>

#include <span>
#include <string_view>
#include <system_error>
#include <vector>

#include "controlspace/error.h"
#include "controlspace/io/write_vtk.h"
#include "controlspace/space/control_space_file.h"
#include "controlspace/trees/octree_pieces.h"

namespace controlspace {
namespace {

/// Collective: each rank writes its piece, then the first the index; where one fails, none is left.
template <class WritePiece, class WriteIndex>
void write_pieces(Ranks& ranks, const std::filesystem::path& index, std::string_view ending,
                  const WritePiece& write_piece, const WriteIndex& write_index) {
    const auto piece_of = [&](int rank) {
        return index.parent_path() / fmt::format("{}_{}{}", index.stem().string(), rank, ending);
    };
    try {
        ranks.together([&] { write_piece(piece_of(ranks.rank())); });
        ranks.together([&] {
            if (ranks.rank() != 0) return;
            std::vector<std::filesystem::path> pieces;
            pieces.reserve(static_cast<std::size_t>(ranks.size()));
            for (int r = 0; r < ranks.size(); ++r) pieces.push_back(piece_of(r));
            write_index(pieces);
        });
    } catch (const InputError&) {
        std::error_code ignored;
        std::filesystem::remove(piece_of(ranks.rank()), ignored);
        throw;
    }
}

}  // namespace

void save_pieces(Ranks& ranks, const Octants& octants, const ControlSpace& own,
                 const std::filesystem::path& index) {
    const auto write_index = [&](std::span<const std::filesystem::path> files) {
        std::vector<OctreePiece> pieces;
        pieces.reserve(files.size());
        for (int r = 0; r < ranks.size(); ++r) {
            pieces.push_back({files[static_cast<std::size_t>(r)], octants.boxes_of_rank(r)});
        }
        write_octree_pieces(index, octants.tree().domain(), pieces);
    };
    write_pieces(
        ranks, index, ".ctrl",
        [&](const std::filesystem::path& piece) { save_control_space(piece, own); }, write_index);
}

void write_pieces_of_leaves(Ranks& ranks, const Octants& octants, const ControlSpace& own,
                            const std::filesystem::path& index) {
    write_pieces(
        ranks, index, ".vtu",
        [&](const std::filesystem::path& piece) {
            write_leaves(piece, own, octants.boxes_of_rank(ranks.rank()));
        },
        [&](std::span<const std::filesystem::path> pieces) { write_leaf_pieces(index, pieces); });
}

}  // namespace controlspace
