// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <string_view>

#include "controlspace/study/measure.h"
#include "controlspace/study/provenance.h"
#include "controlspace/study/study.h"

namespace controlspace {

using Json = nlohmann::ordered_json;

// Of results.json, in which each row is a line.
inline constexpr std::string_view rows_begin = "\n \"rows\": [", row_begin = "\n  {",
                                  rows_end = "\n ]";

/// Null where there is no value.
Json to_json(const MeasuredValue& value);

/// The structure and parameters of a case; those that do not apply are null.
Json to_json(const Case& setting, std::span<const CaseParameter> parameters);

/// The settings of a study but its runs.
Json to_json(const Study& study);

/// A row of results.json: structure, parameters, number of sources, measures, error, files of
/// fields, and labels. What does not apply is null, and so are infinite errors; of a row with an
/// error all measures are.
Json to_json(const Row& row, const StudyRows& rows);

/// The inverse, for rows of a study of `sources`, which give what the parameters do not. Throws
/// InputError or Json::exception for what is no such row.
Row row_from_json(const Json& json, const StudyRows& rows, const SourcesChoice& sources);

/// Everything in results.json before its rows: provenance, settings, defaults of parameters, and
/// descriptions of structures and settings by their names.
Json head_json(const Provenance& provenance, const Study& study, const StudyRows& rows);

/// The provenance, and the study without its runs. Throws as row_from_json does.
Provenance provenance_from_json(const Json& head);
Study study_from_json(const Json& head);

/// Text of `json`, which need not be UTF-8 (file names, command lines): JSON must be.
std::string dump(const Json& json, int indent = -1);

}  // namespace controlspace
