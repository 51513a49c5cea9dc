// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "controlspace/study/measure.h"
#include "study/text_table.h"

namespace controlspace {

struct ParetoPoint {
    std::size_t row = 0;
    double cost = 0;
    double error = 0;
    /// No point of at most this error has a smaller cost, beyond the quartiles of times, and none
    /// of equal cost a smaller error. Rows that a limit stopped are not compared.
    bool on_front = false;
};

/// The rows of the same work: sources, law and reference, at whatever τ, target or voxel.
struct ParetoPlot {
    std::string work;
    std::string cost;                 ///< key: bytes_total or t_access_ns_random
    std::string error;                ///< key: delta_R_fine_max or delta_R_fine_mean
    std::vector<ParetoPoint> points;  ///< in the order of the rows
};

/// Every combination of cost and error for every work with two measured rows or more.
std::vector<ParetoPlot> pareto_plots(std::span<const Row> rows,
                                     std::span<const CaseParameter> parameters = case_parameters());

/// The plots as JSON: [{work, cost, error, points: [{label, cost, error, front}]}].
std::string pareto_json(std::span<const Row> rows,
                        std::span<const CaseParameter> parameters = case_parameters());

/// One table for each work: the rows on a front of largest errors, by rising error.
std::vector<TextTable> pareto_tables(std::span<const Row> rows,
                                     std::span<const CaseParameter> parameters = case_parameters());

}  // namespace controlspace
