#pragma once

#include <string>
#include <vector>

#include "report/figure.h"
#include "report/sampled_fields.h"

namespace controlspace {

/// One figure for each structure: mean length of the exact field and of the structure, with its
/// elements' outlines over it, and δ between the two; anisotropy below, where there is any.
std::vector<Figure> slice_figures(const SampledFields& fields, const std::string& prefix,
                                  const std::string& made_by);

}  // namespace controlspace
