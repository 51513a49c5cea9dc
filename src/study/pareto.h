#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "study/row.h"
#include "study/text_table.h"

namespace controlspace {

/// What a row is weighed by against its error.
enum class ParetoCost { bytes, access };

/// Names and values are those of results.json: bytes_total, t_access_ns_random; δ_R at the finer
/// probes, delta_R_fine_max or delta_R_fine_mean.
enum class ParetoError { max, mean };

struct ParetoPoint {
    std::size_t row = 0;
    double cost = 0;
    double error = 0;
    bool on_front = false;  ///< no other point is at most as large in both and smaller in one
};

/// The rows of the same work: sources, law and reference, at whatever τ, target or voxel.
struct ParetoPlot {
    std::string work;
    ParetoCost cost = ParetoCost::bytes;
    ParetoError error = ParetoError::max;
    std::vector<ParetoPoint> points;  ///< in the order of the rows
};

/// What tells rows of one plot apart: "K_L s_L, tau 0.5".
std::string pareto_label(const Case& c);

/// Every combination of cost and error for every work with two measured rows or more.
std::vector<ParetoPlot> pareto_plots(std::span<const Row> rows);

/// What pareto_plots gives as JSON: [{work, cost, error, points: [{label, cost, error, front}]}].
std::string pareto_json(std::span<const Row> rows);

/// One table a work: the rows on a front of largest errors, by rising error.
std::vector<TextTable> pareto_tables(std::span<const Row> rows);

}  // namespace controlspace
