#pragma once

#include <span>
#include <vector>

#include "controlspace/study/measure.h"
#include "study/text_table.h"

namespace controlspace {

/// A value as its column shows it.
std::string cell_of(const MeasuredValue& value, const Column& column);

/// All measures that have columns, one table for each setting. The note names the fastest
/// structure, where the quartiles of its access times do not overlap with those of others.
std::vector<TextTable> measure_tables(std::span<const Row> rows, const StudyRows& columns);

}  // namespace controlspace
