#pragma once

#include <span>
#include <string>
#include <vector>

#include "study/paper_evidence.h"
#include "study/text_table.h"

namespace controlspace {

/// How many conclusions of the paper stand, and how many cells are equal: two sentences.
std::string paper_headline(const PaperEvidence& evidence);

/// The tables of paper_summary.
std::vector<TextTable> paper_summary_tables(const PaperEvidence& evidence);

/// The experiments, and every cell with its verdict.
std::vector<TextTable> paper_detail_tables(const PaperEvidence& evidence);

/// What to see in a minute: which conclusions of the paper stand, the ranks, how many cells of each
/// table are equal, explained or not, and every cell that is not explained.
std::string paper_summary(const PaperEvidence& evidence, TableStyle style);

/// paper.md: the summary, the experiments, and every cell with its verdict. `origins`
/// say, one line each, where the rows are from.
std::string paper_page(const PaperEvidence& evidence, std::span<const std::string> origins);

}  // namespace controlspace
