#pragma once

#include <nlohmann/json_fwd.hpp>

#include "study/row.h"

namespace controlspace {

/// The fields of a row in results.json and the columns of results.csv, in order. Times in seconds
/// (`_s`) and nanoseconds per query (`_ns`), memory in bytes; `coarser_max` and `coarser_share` as
/// in Accuracy. Fields that do not apply are null, and infinite errors; of a row with an `error`
/// all measures are.
nlohmann::ordered_json to_json(const Row& row);

/// The way back, for rows of a study of `sources`, whose sampling, rho, s_a, s_n and kind of field
/// are the row's. What is not written stays as it is in an empty row: the worst place, the
/// Riemannian maximum of the finer probes, the checksum of access in order. `coarser_max` and
/// `coarser_share` are no numbers in rows that have none. Throws InputError or nlohmann::json::exception for what is no such row.
Row row_from_json(const nlohmann::ordered_json& json, const SourcesChoice& sources);

}  // namespace controlspace
