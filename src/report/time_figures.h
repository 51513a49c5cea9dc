#pragma once

#include <span>
#include <string>
#include <vector>

#include "report/figure.h"
#include "report/style.h"
#include "study/row.h"

namespace controlspace {

/// Raw samples of the access time as boxes, at random places and in order: one figure for each
/// setting and mode. Names begin with `prefix`.
std::vector<Figure> access_figures(std::span<const Row> rows, const std::string& prefix,
                                   const std::string& made_by);

/// Creation time over the number of sources: one figure for rows that differ in the structure and
/// the density of the sources only, where there are two densities or more.
std::vector<Figure> creation_figures(std::span<const Row> rows, const Styles& styles,
                                     const std::string& prefix, const std::string& made_by);

}  // namespace controlspace
