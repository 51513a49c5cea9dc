// SPDX-License-Identifier: Apache-2.0

#include <string_view>

#include "controlspace/study/results.h"
#include "files/text_file.h"
#include "refuse.h"
#include "study/results_json.h"

namespace controlspace {
namespace {

StoredResults results_from(const Json& json, const StudyRows& rows) {
    if (!json.is_object() || !json.contains("program") || json["program"] != "controlspace") {
        refuse("not written by this program: give a folder of results");
    }
    if (json.at("schema_version") != results_schema_version) {
        refuse("schema version {} is not {}: run the study again", json.at("schema_version").dump(),
               results_schema_version);
    }
    StoredResults results{
        provenance_from_json(json), study_from_json(json), {}, json.at("complete").get<bool>()};
    if (!json.at("rows").is_array()) refuse("rows is no list of rows");
    for (const Json& row : json.at("rows")) {
        try {
            results.rows.push_back(row_from_json(row, rows, results.study.sources));
        } catch (const std::exception& error) {
            refuse("row {}: {}", results.rows.size() + 1, error.what());
        }
    }
    return results;
}

/// The text up to the end of the last row that is whole, closed as that of an interrupted run: the
/// program may have been killed while it wrote. As it is where no row has begun.
std::string without_torn_end(std::string text) {
    const std::size_t rows = text.find(rows_begin);
    if (rows == std::string::npos) return text;
    const std::size_t first = rows + rows_begin.size();
    std::size_t end = text.find(rows_end, first);
    if (end == std::string::npos) end = text.rfind(row_begin);
    if (end == std::string::npos || end < first) return text;
    text.resize(end);
    if (text.back() == ',') text.pop_back();
    return text.append(rows_end).append(",\n \"complete\": false\n}\n");
}

Json parsed(const std::string& text) {
    try {
        return Json::parse(text);
    } catch (const Json::parse_error&) {
        return Json::parse(without_torn_end(text));
    }
}

/// Whether `row` is the outcome of `c`, whose voxels may have been chosen by the study itself.
bool is_outcome_of(const Row& row, Case c) {
    if (c.equal_delta || c.equal_memory) {
        c.voxel = row.setting.voxel;
        c.prune_delta = row.setting.prune_delta;
    }
    return row.setting == c;
}

void require_same_program(const Provenance& earlier, const Provenance& now) {
    const auto same = [](std::string_view what, std::string_view a, std::string_view b) {
        if (a == b) return;
        refuse(
            "{} was \"{}\" and is \"{}\" now: run the study anew, since times of the "
            "two cannot be compared",
            what, a, b);
    };
    same("the program", version_text(earlier), version_text(now));
    same("the compiler", earlier.compiler + ", " + earlier.flags, now.compiler + ", " + now.flags);
    same("the processor", earlier.cpu, now.cpu);
}

void require_same_settings(const Study& earlier, const Study& now) {
    for (const Parameter<Study>& p : study_parameters()) {
        const bool changes_no_row = p.use == Use::results || p.key == "threads";
        if (changes_no_row || p.access.get(earlier) == p.access.get(now)) continue;
        refuse("{} differs from what it was: give the same settings, or run the study anew", p.key);
    }
}

}  // namespace

StoredResults read_results(const std::filesystem::path& folder, const StudyRows& rows) {
    const auto file = folder / "results.json";
    const std::string text = read_text_file(file);
    try {
        return results_from(parsed(text), rows);
    } catch (const std::exception& error) {
        refuse_at(file, "{}", error.what());
    }
}

std::vector<Row> rows_to_go_on_from(const StoredResults& earlier, const Study& study,
                                    std::span<const Case> cases, const Provenance& now) {
    require_same_settings(earlier.study, study);
    for (std::size_t i = 0; i < earlier.rows.size(); ++i) {
        if (i < cases.size() && is_outcome_of(earlier.rows[i], cases[i])) continue;
        refuse(
            "row {} is {}, which is no case {} of this study: give the study that was interrupted",
            i + 1, structure_label(earlier.rows[i].setting), i + 1);
    }
    if (earlier.complete && earlier.rows.size() < cases.size()) {
        refuse(
            "these results are complete with {} cases, and this study has {}: run it anew, or the "
            "others alone",
            earlier.rows.size(), cases.size());
    }
    if (earlier.complete) refuse("these results are complete: nothing is left to run");
    require_same_program(earlier.provenance, now);
    return earlier.rows;
}

}  // namespace controlspace
