#pragma once

#include <filesystem>
#include <string_view>
#include <vector>

#include "controlspace/sources/point_source.h"
#include "io/text/medit_blocks.h"
#include "io/text/medit_words.h"
#include "io/text/text_file.h"

namespace controlspace {

/// Sources at the vertices of a Medit mesh (`.mesh`, or binary `.meshb`), with the sizes of its
/// solution (`.sol`, `.solb`): one field, either scalar, the length h, or a symmetric tensor, the
/// Riemannian metric M^-2 by its lower triangle, xx xy yy xz yz zz, which is converted to M. Which
/// of the two forms a file has is told by its first bytes.
/// Throws InputError "name:line: what is wrong", "name, byte n: what is wrong", or naming the
/// tensor that is not positive definite.
std::vector<PointSource> read_medit_sources(const std::filesystem::path& mesh,
                                            const std::filesystem::path& solution);

/// The vertices alone.
std::vector<Point> read_medit_vertices(const std::filesystem::path& mesh);

/// The two readers alone, for contents at hand; the paths are for messages.
std::vector<Point> parse_medit_vertices(std::string_view bytes, const std::filesystem::path& path);
std::vector<Metric> parse_medit_metrics(std::string_view bytes, const std::filesystem::path& path);

/// Calls `read` with what reads these contents, a MeditWords or a MeditBlocks at their beginning.
template <class Read>
auto read_medit(std::string_view bytes, const std::filesystem::path& path, Read&& read) {
    if (MeditBlocks::are_in(bytes)) {
        MeditBlocks blocks(bytes, path);
        return read(blocks);
    }
    MeditWords words(text_in(bytes, path), path);
    return read(words);
}

}  // namespace controlspace
