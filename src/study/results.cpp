// SPDX-License-Identifier: Apache-2.0
#include "controlspace/study/results.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <fstream>
#include <utility>

#include "files/output_file.h"
#include "refuse.h"
#include "study/outcome.h"
#include "study/results_json.h"
#include "study/sampled_fields.h"
#include "study/tables.h"

namespace controlspace {
namespace {

/// One field of a CSV file, quoted where it has to be (RFC 4180).
std::string csv_field(const Json& value) {
    if (value.is_null()) return "";
    if (value.is_array()) {
        std::vector<std::string> items;
        for (const Json& item : value) items.push_back(dump(item));
        return fmt::format("{}", fmt::join(items, " "));
    }
    if (!value.is_string()) return dump(value);
    const auto& text = value.get_ref<const std::string&>();
    if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
    std::string quoted = "\"";
    for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
    return quoted + '"';
}

/// A line of what `field` makes of each key and value of a row but its files and labels.
template <class Field>
std::string csv_line(Json json, const Field& field) {
    json.erase("fields");
    json.erase("labels");
    std::string text;
    for (const auto& [key, value] : json.items()) text += field(key, value) + ',';
    text.back() = '\n';
    return text;
}

std::string csv_line(const Row& row, const StudyRows& rows) {
    return csv_line(to_json(row, rows),
                    [](const std::string&, const Json& value) { return csv_field(value); });
}

/// A row in the list of results.json; rows are on one line each.
std::string json_line(const Row& row, const StudyRows& rows, bool is_first) {
    return (is_first ? "\n  " : ",\n  ") + dump(to_json(row, rows));
}

std::string json_tail(bool complete, std::span<const Outcome> outcomes = {}) {
    std::string lines;
    for (const Outcome& outcome : outcomes) {
        lines.append(lines.empty() ? "\n  " : ",\n  ").append(dump(to_json(outcome)));
    }
    return fmt::format("{},\n \"outcomes\": [{}],\n \"complete\": {}\n}}\n", rows_end, lines,
                       complete);
}

std::string json_text(const Provenance& provenance, const Study& study, const StudyRows& rows,
                      std::span<const Row> written) {
    std::string text = dump(head_json(provenance, study, rows), 1);
    text.erase(text.rfind("\n}"));
    text.append(",").append(rows_begin);
    for (const Row& row : written) text += json_line(row, rows, &row == &written.front());
    return text;
}

std::string csv_text(const StudyRows& rows, std::span<const Row> written) {
    std::string text =
        csv_line(to_json(Row{}, rows), [](const std::string& key, const Json&) { return key; });
    for (const Row& row : written) text += csv_line(row, rows);
    return text;
}

std::filesystem::path made(std::filesystem::path folder) {
    make_results_folder(folder, "results.json");
    return folder;
}

}  // namespace

GrowingFile::GrowingFile(std::filesystem::path path, std::string_view text, std::string tail)
    : path_(std::move(path)), end_(text.size()), tail_(std::move(tail)) {
    replace_file(path_, std::string(text) + tail_);
}

void GrowingFile::append(std::string_view text, std::string tail) {
    const auto write = [&](const std::string& what) {
        std::fstream file(path_, std::ios::in | std::ios::out | std::ios::binary);
        file.seekp(static_cast<std::streamoff>(end_));
        file.write(what.data(), static_cast<std::streamsize>(what.size())).flush();
        std::error_code error;
        std::filesystem::resize_file(path_, end_ + (file ? what.size() : tail_.size()), error);
        return file && !error;
    };
    if (!write(std::string(text) + tail)) {
        write(tail_);
        refuse("{} cannot be written: is the disk full?", path_.string());
    }
    end_ += text.size();
    tail_ = std::move(tail);
}

ResultsFolder::ResultsFolder(std::filesystem::path folder, Provenance provenance, Study study,
                             const StudyRows& rows)
    : ResultsFolder(made(std::move(folder)), std::move(provenance), std::move(study), rows, {}) {}

ResultsFolder::ResultsFolder(std::filesystem::path folder, Provenance provenance, Study study,
                             const StudyRows& rows, std::vector<Row> earlier)
    : provenance_(std::move(provenance)),
      study_(std::move(study)),
      rows_(rows),
      folder_(std::move(folder)),
      written_(std::move(earlier)),
      json_(folder_ / "results.json", json_text(provenance_, study_, rows_, written_),
            json_tail(false)),
      csv_(folder_ / "results.csv", csv_text(rows_, written_), "") {
    for (const Row& row : written_) {
        if (row.fields) sampled_.push_back(row.setting);
    }
}

void ResultsFolder::sample_fields(const Finished& finished, Row& row) {
    const Case& c = row.setting;
    const bool is_wanted =
        sampled_.empty() ||
        (setting_label(c, rows_.parameters) == setting_label(sampled_.front(), rows_.parameters) &&
         c.sources == sampled_.front().sources &&
         std::ranges::none_of(sampled_, [&](const Case& s) { return s.structure == c.structure; }));
    if (!is_wanted) return;
    row.fields = write_sampled_fields(folder_, finished, !sampled_.empty());
    sampled_.push_back(c);
}

void ResultsFolder::add(const Row& row) {
    json_.append(json_line(row, rows_, written_.empty()), json_tail(false));
    csv_.append(csv_line(row, rows_), "");
    written_.push_back(row);
}

void ResultsFolder::finish(bool complete) {
    json_.append("", json_tail(complete, outcomes(written_, rows_)));
}

std::string tables_text(std::span<const Row> rows, const StudyRows& columns) {
    return render(measure_tables(rows, columns)) + outcome_text(rows, columns);
}

void replace_file(const std::filesystem::path& path, std::string_view text) {
    OutputFile file(path);
    file.write(text);
    file.commit();
}

void make_results_folder(const std::filesystem::path& folder, std::string_view file) {
    std::error_code error;
    std::filesystem::create_directories(folder, error);
    if (error || !std::filesystem::is_directory(folder)) {
        refuse_at(folder, "cannot be made ({}): choose another output folder",
                  error ? error.message() : "it is a file");
    }
    if (std::filesystem::exists(folder / file, error)) {
        refuse_at(folder, "contains results already: choose another output folder");
    }
}

std::filesystem::path results_path(const Study& study, const Provenance& provenance) {
    if (!study.output.empty()) return study.output;
    std::string stamp;  // 2024-05-01T12:00:00Z -> 20240501-120000
    for (const char c : provenance.date) {
        if (c == 'T') stamp += '-';
        if (c >= '0' && c <= '9') stamp += c;
    }
    return std::filesystem::path("results") / (study.name + "-" + stamp);
}

}  // namespace controlspace
