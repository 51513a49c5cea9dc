#pragma once

#include <vector>

#include "study/paper_evidence.h"
#include "study/text_table.h"

namespace controlspace {

/// The experiments that the verdicts on the paper's tables rest on, one table each, with our
/// numbers beside the paper's. An experiment of which nothing is at hand has a table without rows
/// and a note that says so.
std::vector<TextTable> paper_experiments(const PaperEvidence& evidence);

/// Spearman's rho between our columns and the paper's, for each of its tables and settings: over
/// all rows, and over the rows that no fault of the published program touches.
TextTable rank_table(const PaperEvidence& evidence);

}  // namespace controlspace
