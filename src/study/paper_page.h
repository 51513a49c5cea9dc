#pragma once

#include <span>
#include <string>
#include <vector>

#include "study/paper_evidence.h"
#include "study/text_table.h"

namespace controlspace {

/// What to see in a minute: which conclusions of the paper stand, the ranks, how many cells of each
/// table are equal, explained or not, and every cell that is not explained.
std::string paper_summary(const PaperEvidence& evidence, TableStyle style);

/// paper.md: the summary, the experiments, and every cell with its verdict. `origins`
/// say, one line each, where the rows are from.
std::string paper_page(const PaperEvidence& evidence, std::span<const std::string> origins);

}  // namespace controlspace
