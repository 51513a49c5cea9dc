#pragma once

#include <span>
#include <string>
#include <vector>

#include "study/row.h"
#include "study/study.h"
#include "study/text_table.h"

namespace controlspace {

/// The paper's Tables 1-4 with its values beside ours, for rows that were run as published on the
/// paper's sphere and domain; tables without rows are left out.
std::vector<TextTable> paper_comparison(const Study& study, std::span<const Row> rows);

/// All measures of all rows, one table for each setting and mode.
std::vector<TextTable> measure_tables(std::span<const Row> rows);

/// Both, one after the other, and the fronts (pareto_tables).
std::string render_tables(const Study& study, std::span<const Row> rows, TableStyle style);

}  // namespace controlspace
