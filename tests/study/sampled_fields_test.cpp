// SPDX-License-Identifier: Apache-2.0
// Fields of structures as `compare` writes them, read back from their files.
#include "study/sampled_fields.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cstring>
#include <filesystem>

#include "controlspace/metric/nonconformity.h"
#include "controlspace/study/results.h"
#include "controlspace/study/run.h"
#include "scratch_directory.h"

namespace controlspace::sampled_fields_test {

using Catch::Matchers::Contains;

namespace {

/// A small study with its results in a folder.
std::vector<Row> rows_in(const std::filesystem::path& folder, double s_n) {
    Study study;
    study.sources.h = 0.2;
    study.access_points = 10;
    study.access_repeats = study.creation_repeats = 1;
    study.probe_grid = 9;
    study.fine_probe_grid = 2;
    study.runs[0] = {{"structures", {"K_oL", "K_V"}}, {"splits", {"s_L"}}, {"tau", {1, 0.5}}};
    study.runs[0]["s_n"] = {s_n};
    const StudyRows rows{tree_catalogue()};
    ResultsFolder results(folder, {}, study, rows);
    StudyObserver observer;
    observer.case_checked = [&](const Finished& f, Row& row) { results.sample_fields(f, row); };
    observer.case_finished = [&](const Row& row) { results.add(row); };
    PreparedStudy(study, rows).run(observer);
    return {results.rows().begin(), results.rows().end()};
}

/// The numbers behind the header of a .npy file, whose shape is as in Python.
std::vector<double> numbers_of(const std::filesystem::path& file, const std::string& shape) {
    const std::string text = file_text(file);
    REQUIRE(text.substr(0, 8) == std::string("\x93NUMPY\x01\x00", 8));
    const std::size_t header = static_cast<unsigned char>(text[8]) +
                               256 * static_cast<std::size_t>(static_cast<unsigned char>(text[9]));
    CHECK((10 + header) % 64 == 0);
    CHECK_THAT(text.substr(10, header), Contains("'<f8'") && Contains("'shape': (" + shape));
    std::vector<double> numbers((text.size() - 10 - header) / sizeof(double));
    std::memcpy(numbers.data(), text.data() + 10 + header, numbers.size() * sizeof(double));
    return numbers;
}

Metric metric_at(const std::vector<double>& numbers, std::size_t i) {
    const double* m = &numbers[6 * i];
    return {m[0], m[1], m[2], m[3], m[4], m[5]};
}

}  // namespace

TEST_CASE("of the first setting, each structure's field is sampled once, as it was measured") {
    const ScratchDirectory folder;
    const auto rows = rows_in(folder / "a", 0.5);
    REQUIRE(rows.size() == 4);
    CHECK((rows[0].fields && rows[1].fields && !rows[2].fields && !rows[3].fields));
    CHECK(rows[1].fields->slice == "fields/001-slice.npy");
    CHECK(rows[1].fields->z == 0);
    const auto exact = numbers_of(folder / "a" / rows[0].fields->exact_probes, "9, 9, 9, 6");
    CHECK(numbers_of(folder / "a" / rows[0].fields->exact_slice, "200, 200, 6").size() == 240'000);
    for (std::size_t r = 0; r < 2; ++r) {
        const auto probes = numbers_of(folder / "a" / rows[r].fields->probes, "9, 9, 9, 6");
        REQUIRE(probes.size() == exact.size());
        double largest = 0;
        for (std::size_t i = 0; i < probes.size() / 6; ++i) {
            largest = std::max(largest, nonconformity(metric_at(probes, i), metric_at(exact, i)));
        }
        CHECK(largest == Approx(rows[r].number("delta_R_max")).epsilon(1e-12));
        CHECK(largest > 0);
    }
}

TEST_CASE("the cells on a slice tile it") {
    const ScratchDirectory folder;
    for (const Row& row : rows_in(folder / "a", 1)) {
        if (!row.fields) continue;
        const auto outlines = numbers_of(folder / "a" / row.fields->outlines, "");
        CHECK(outlines.size() > 4 * 20);
        double area = 0;
        for (std::size_t i = 0; i < outlines.size(); i += 4) {
            area += (outlines[i + 2] - outlines[i]) * (outlines[i + 3] - outlines[i + 1]);
        }
        CHECK(area == Approx(4));
    }
    const auto space =
        tree_catalogue()[0].make({.domain = {Point::Constant(-1), Point::Constant(1)}})->build();
    CHECK(cells_on_slice(*space, 0.3, 10)->size() == 1);
    CHECK_FALSE(cells_on_slice(*space, 0.3, 0));
    for (Axis a = 0; a < 3; ++a) {
        Box flat{Point(0, 1, 2), Point(5, 7, 9)};
        flat.high[a] = flat.low[a];
        const auto cells =
            cells_on_slice(*tree_catalogue()[0].make({.domain = flat})->build(), flat.low[a], 10);
        CHECK(cells == std::vector{flat});
        const auto [u, v] = slice_axes(flat);
        CHECK((u < v && u + v + a == 3));
    }
}

}  // namespace controlspace::sampled_fields_test
