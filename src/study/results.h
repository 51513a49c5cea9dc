#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>

#include "study/provenance.h"
#include "study/row.h"
#include "study/study.h"

namespace controlspace {

/// Of results.json: another number where its fields mean something else.
constexpr int results_schema_version = 1;

/// results.json: provenance, settings and rows with all raw samples. `complete` is false while
/// cases are still to come.
std::string results_json(const Provenance& provenance, const Study& study,
                         std::span<const Row> rows, bool complete);

/// results.csv: the rows' fields as columns; samples of one field are separated by blanks.
std::string results_csv(std::span<const Row> rows);

/// summary.md: provenance and tables.
std::string results_summary(const Provenance& provenance, const Study& study,
                            std::span<const Row> rows, bool complete);

/// One line: which program, machine and command line made results, and when.
std::string origin_text(const Provenance& provenance, bool complete);

/// Makes a folder for results with its parents. Throws InputError if that fails, or if `file`,
/// which marks results, lies there already.
void make_results_folder(const std::filesystem::path& folder, std::string_view file);

/// Replaces `path` at once: readers see the old text or the new one, never a part. Throws
/// InputError.
void replace_file(const std::filesystem::path& path, std::string_view text);

/// The folder a study's results go to. Each write replaces each file at once, so that whatever
/// happens whole files lie there.
class ResultsFolder {
public:
    /// Makes the folder with its parents. Throws InputError if that fails, if results lie there
    /// already, or if it cannot be written to.
    explicit ResultsFolder(std::filesystem::path folder);
    /// The folder of a run that goes on: it is there, and what it holds is replaced.
    static ResultsFolder existing(std::filesystem::path folder);

    const std::filesystem::path& path() const { return folder_; }

    /// Writes results.json, results.csv, summary.md and pareto.json (see pareto.h). Throws
    /// InputError, naming the file, if one cannot be written.
    void write(const Provenance& provenance, const Study& study, std::span<const Row> rows,
               bool complete) const;

private:
    ResultsFolder() = default;
    std::filesystem::path folder_;
};

/// study.output, or results/NAME-DATE-TIME (UTC).
std::filesystem::path results_path(const Study& study, const Provenance& provenance);

}  // namespace controlspace
