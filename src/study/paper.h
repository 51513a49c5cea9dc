#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "study/case.h"

namespace controlspace {

/// One row of the paper's Tables 1-5: a structure at one setting of the sphere.
struct PaperRow {
    std::string structure;
    std::optional<SplitRule> split;
    double rho = 0;
    double tau = 0;
    double size_mb = 0;      ///< Table 1, 1 MB = 1e6 bytes, in the paper's own accounting
    double creation_s = 0;   ///< Table 2
    double access_us = 0;    ///< Table 3
    double delta_r_max = 0;  ///< Table 4
    double l_r = 0;          ///< Table 5
};

/// Reads the form of data/paper/sphere_tables.csv; throws InputError that names the line.
std::vector<PaperRow> parse_paper_tables(std::string_view csv);

/// The text of data/paper/sphere_tables.csv.
std::string_view paper_tables_text();

/// The paper's own tables, parsed once.
std::span<const PaperRow> paper_rows();

/// The paper's row for `c`; none where the paper has no such structure or setting: its sphere has
/// r = 0.8, h = 0.015, s_a = 2, s_n = 1, g_r = 1.25, epsilon = 0.2 and depths of 42 and 14.
const PaperRow* paper_row(const Case& c);

}  // namespace controlspace
