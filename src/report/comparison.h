#pragma once

#include <span>
#include <string>
#include <vector>

#include "report/figure.h"
#include "study/row.h"
#include "study/study.h"
#include "study/text_table.h"

namespace controlspace {

/// Two measured rows of the same setting.
struct RowPair {
    const Row* before;
    const Row* after;
};

/// The rows of the same setting and as many sources, in the order of `before`; each is in one pair
/// at most. Valid as long as the rows are.
std::vector<RowPair> row_pairs(std::span<const Row> before, std::span<const Row> after);

/// Settings of the studies as a whole that differ, name and output apart: "fine_probe_grid (101,
/// 20), seed (1, 2)"; empty where none does.
std::string differing_settings(const Study& before, const Study& after);

/// A quotient of two medians, and what the scatter of the samples makes of it: from the lower
/// quartile of the later ones over the upper one of the earlier, to the reverse.
struct NoisyRatio {
    double value = 1;
    double low = 1;
    double high = 1;

    /// Whether the scatter alone explains it.
    bool is_within_noise() const { return low <= 1 && 1 <= high; }
};
NoisyRatio access_ratio(const AccessTime& before, const AccessTime& after);

/// How many rows became faster, smaller and more accurate: a table with a row for each measure.
TextTable change_counts(std::span<const RowPair> pairs);

/// After over before, for each row: one table a setting.
std::vector<TextTable> change_tables(std::span<const RowPair> pairs);

/// The same as pictures. Names begin with `prefix`.
std::vector<Figure> change_figures(std::span<const RowPair> pairs, const std::string& prefix,
                                   const std::string& made_by);

}  // namespace controlspace
