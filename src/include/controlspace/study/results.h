// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "controlspace/study/measure.h"
#include "controlspace/study/provenance.h"
#include "controlspace/study/study.h"

namespace controlspace {

/// Of results.json: another number where its fields mean something else.
constexpr int results_schema_version = 2;

/// The contents of a folder of results.
struct StoredResults {
    Provenance provenance;
    Study study;  ///< with default runs: the cases are in the rows
    std::vector<Row> rows;
    bool complete = false;
};

/// Reads FOLDER/results.json; of a file that was torn while the last row was written, the others.
/// Throws InputError, naming the file and the row (from 1), for a file
/// that is missing, damaged or of another schema, and for other parameters or measures than those
/// of `rows`.
StoredResults read_results(const std::filesystem::path& folder, const StudyRows& rows);

/// The rows of an interrupted run of `study`: those of its first cases, in order. Throws InputError
/// for results that cannot be continued: complete ones, those of another study or other settings,
/// and those made by another build or on another processor.
std::vector<Row> rows_to_go_on_from(const StoredResults& earlier, const Study& study,
                                    std::span<const Case> cases, const Provenance& now);

/// A text file to which text is appended in front of a fixed end; complete after every call.
class GrowingFile {
public:
    /// Replaces the file by `text` and `tail`. Throws InputError, naming it, if that fails.
    GrowingFile(std::filesystem::path path, std::string_view text, std::string tail);
    /// Adds `text` in front of `tail`, which replaces the one before. If that fails, the file stays
    /// as it was, and InputError is thrown.
    void append(std::string_view text, std::string tail);

private:
    std::filesystem::path path_;
    std::uintmax_t end_;  ///< of the text
    std::string tail_;
};

/// The folder of a study's results, a sink for its rows. Each row is appended to results.json and
/// results.csv, which are complete at any time; the sampled fields of the first setting are written
/// to fields/. bench/tables makes tables in Markdown and Pareto fronts from it.
class ResultsFolder {
public:
    /// Makes the folder with its parents. Throws InputError if that fails, if results are in it
    /// already, or if it cannot be written to.
    ResultsFolder(std::filesystem::path folder, Provenance provenance, Study study,
                  const StudyRows& rows);
    /// The folder of an interrupted run, which contains `earlier` rows and is continued.
    ResultsFolder(std::filesystem::path folder, Provenance provenance, Study study,
                  const StudyRows& rows, std::vector<Row> earlier);

    const std::filesystem::path& path() const { return folder_; }
    std::span<const Row> rows() const { return written_; }

    /// Samples the field of a structure of the first setting, and enters the
    /// files in `row`. For StudyObserver::case_checked.
    void sample_fields(const Finished& finished, Row& row);
    /// Throws InputError, naming the file, if it cannot be written.
    void add(const Row& row);
    /// Adds which structures to take; `complete` is false where cases are missing.
    void finish(bool complete);

private:
    Provenance provenance_;
    Study study_;
    StudyRows rows_;
    std::filesystem::path folder_;
    std::vector<Row> written_;
    std::vector<Case> sampled_;  ///< whose fields are in files
    GrowingFile json_;
    GrowingFile csv_;
};

/// For the terminal: the measures for each setting, then which structures to take.
std::string tables_text(std::span<const Row> rows, const StudyRows& columns);

/// Makes a folder for results with its parents. Throws InputError if that fails, or if `file`,
/// which marks results, is in it already.
void make_results_folder(const std::filesystem::path& folder, std::string_view file);

/// Replaces `path` at once: readers see the old text or the new one, never a part. Throws
/// InputError.
void replace_file(const std::filesystem::path& path, std::string_view text);

/// study.output, or results/NAME-DATE-TIME (UTC).
std::filesystem::path results_path(const Study& study, const Provenance& provenance);

}  // namespace controlspace
