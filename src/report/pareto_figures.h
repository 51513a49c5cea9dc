#pragma once

#include <span>
#include <string>
#include <vector>

#include "report/figure.h"
#include "report/style.h"
#include "study/paper_evidence.h"
#include "study/row.h"

namespace controlspace {

/// The plots of study/pareto.h, error over cost, with their fronts. Names begin with `prefix`.
std::vector<Figure> pareto_figures(std::span<const Row> rows, const Styles& styles,
                                   const std::string& prefix, const std::string& made_by);

/// Ours and the paper's points where they are comparable, largest δ_R over the size in the paper's
/// own accounting: one figure a density of sources.
std::vector<Figure> paper_figures(const PaperEvidence& evidence, const Styles& styles,
                                  const std::string& prefix, const std::string& made_by);

}  // namespace controlspace
