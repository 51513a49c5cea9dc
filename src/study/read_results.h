#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "study/provenance.h"
#include "study/row.h"
#include "study/study.h"

namespace controlspace {

/// What a file of results holds.
struct StoredResults {
    Provenance provenance;
    Study study;  ///< its runs are left as they are by default: the rows say what was run
    std::vector<Row> rows;
    bool complete = false;
};

/// Reads FOLDER/results.json as ResultsFolder writes it. Throws InputError, naming the file, and
/// the row counted from 1, for what cannot be read, is no such file, or is of another schema.
StoredResults read_results(const std::filesystem::path& folder);

}  // namespace controlspace
