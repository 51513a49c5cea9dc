#pragma once

#include <nlohmann/json_fwd.hpp>

#include "study/row.h"

namespace controlspace {

/// The fields of a row in results.json and the columns of results.csv, in order. Times in seconds
/// (`_s`) and nanoseconds per query (`_ns`), memory in bytes. Fields that do not apply are null; of
/// a row with an `error` all measures are.
nlohmann::ordered_json to_json(const Row& row);

}  // namespace controlspace
