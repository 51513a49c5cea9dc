#pragma once

#include <span>
#include <string>
#include <vector>

#include "study/row.h"
#include "study/text_table.h"

namespace controlspace {

/// All measures of all rows, one table for each setting and mode.
std::vector<TextTable> measure_tables(std::span<const Row> rows);

/// The same, and the fronts (pareto_tables).
std::string render_tables(std::span<const Row> rows, TableStyle style);

}  // namespace controlspace
