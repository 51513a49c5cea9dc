#pragma once

#include <filesystem>
#include <string_view>
#include <vector>

#include "sources/point_source.h"

namespace controlspace {

/// Sources at the vertices of a Medit mesh (ASCII `.mesh`), with the sizes of its solution (ASCII
/// `.sol`): one field, either scalar, the length h, or a symmetric tensor, the Riemannian metric
/// M^-2 by its lower triangle, xx xy yy xz yz zz, which is converted to M.
/// Throws InputError "name:line: what is wrong", or naming the tensor that is not positive
/// definite.
std::vector<PointSource> read_medit_sources(const std::filesystem::path& mesh,
                                            const std::filesystem::path& solution);

/// The two readers alone, for texts at hand; the paths are for messages.
std::vector<Point> parse_medit_vertices(std::string_view text, const std::filesystem::path& path);
std::vector<Metric> parse_medit_metrics(std::string_view text, const std::filesystem::path& path);

}  // namespace controlspace
