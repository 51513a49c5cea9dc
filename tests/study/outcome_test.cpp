// SPDX-License-Identifier: Apache-2.0
#include "study/outcome.h"

#include <catch2/catch.hpp>

#include "controlspace/metric/nonconformity.h"
#include "study/sample_rows.h"

namespace controlspace::outcome_test {

using Catch::Matchers::Contains;
using Indices = std::vector<std::size_t>;

namespace {

/// A row that was measured: its largest factor between lengths, memory and access times.
Row row_of(const char* structure, double factor, std::int64_t bytes, std::vector<double> samples_ns,
           std::size_t batch = 0) {
    const Case c{.structure = structure};
    Finished finished = sample_finished(c);
    finished.access_random.samples_ns = std::move(samples_ns);
    finished.access_batch = batch;
    Row row;
    row.setting = c;
    for (const Measure& measure : measures()) row.values[measure.key] = measure.value(finished);
    row.values["within_max"] = 1.0;
    row.values["within_fine_max"] = factor;
    row.values["delta_R_max"] = 0.0;
    row.values["delta_R_fine_max"] = nonconformity_of_factor(factor);
    row.values["bytes_total"] = bytes;
    return row;
}

std::vector<Row> sample() {
    return {row_of("coarse", 1.6, 100'000, {5, 5, 5}), row_of("fast", 1.2, 900'000, {9, 10, 11}),
            row_of("small", 1.24, 410'000, {18, 19, 20}),
            row_of("exact", 1.0, 5'000'000, {900, 1000, 1100})};
}

Outcome only(const std::vector<Row>& rows) {
    const auto all = outcomes(rows, tree_rows());
    REQUIRE(all.size() == 1);
    return all.front();
}

}  // namespace

TEST_CASE("the smallest, the fastest and the most accurate are those within the error") {
    const Outcome outcome = only(sample());
    CHECK(outcome.factor == 1.25);
    CHECK_FALSE(outcome.is_asked);
    CHECK(outcome.within == Indices{1, 2, 3});
    CHECK(outcome.smallest == Indices{2});
    CHECK(outcome.fastest == Indices{1});
    CHECK(outcome.most_accurate == Indices{3});
    REQUIRE(outcome.sentences.size() == 5);
    CHECK_THAT(outcome.sentences[0], Contains("1.25x") && Contains("3 of 4 rows"));
    CHECK_THAT(outcome.sentences[1], Contains("small (0.41 MB, 19.0 ns") && Contains("1.240x"));
    CHECK_THAT(outcome.sentences[2], Contains("fast (0.9 MB, 10.0 ns") && Contains("1.200x"));
    CHECK_THAT(outcome.sentences[3], Contains("exact (5 MB, 1000.0 ns") && Contains("1.000x"));
    CHECK_THAT(outcome.sentences[4], Contains("--within 1.25"));
    std::vector<Row> grids = sample();
    for (Row& row : grids) row.values["tree_nodes"] = std::int64_t{0};
    CHECK(only(grids).sentences.size() == 4);
}

TEST_CASE("either kind of probes puts a structure out, and so does an infinite error") {
    std::vector<Row> rows = sample();
    rows[1].values["within_max"] = 1.3;
    CHECK(only(rows).within == Indices{2, 3});
    rows[2].values["within_fine_max"] = std::numeric_limits<double>::infinity();
    CHECK(only(rows).within == Indices{3});
    rows[3].values["within_fine_max"] = std::numeric_limits<double>::quiet_NaN();
    CHECK(only(rows).within.empty());
}

TEST_CASE("what a limit stopped is not ranked, and is named") {
    std::vector<Row> rows = sample();
    const std::string stopped = "stopped at 60 s, 1234 leaves, δ 0.02 reached";
    rows[2].values["stopped"] = stopped;
    const Outcome outcome = only(rows);
    CHECK(outcome.measured == 4);
    CHECK(outcome.within == Indices{1, 3});
    CHECK(outcome.smallest == Indices{1});
    CHECK(outcome.sentences.back() == "Not ranked: small (" + stopped + ").");
    for (Row& row : rows) row.values["stopped"] = stopped;
    const Outcome none = only(rows);
    CHECK(none.within.empty());
    CHECK(none.smallest.empty());
    CHECK(none.sentences.size() == 3);
}

TEST_CASE("times whose quartiles overlap are indistinguishable, in one batch") {
    std::vector<Row> rows = sample();
    rows.push_back(row_of("near", 1.1, 1'000'000, {10, 11, 12}));
    CHECK(only(rows).fastest == Indices{1, 4});
    CHECK_THAT(only(rows).sentences[2],
               Contains("indistinguishable between fast (0.9 MB, ") && Contains(" and near (1 MB"));
    rows.back() = row_of("near", 1.1, 1'000'000, {8, 9, 10});
    CHECK(only(rows).fastest == Indices{4, 1});
    rows.back() = row_of("far", 1.1, 1'000'000, {12, 13, 14});
    CHECK(only(rows).fastest == Indices{1});
    rows.back() = row_of("later", 1.1, 1'000'000, {1, 1, 1}, 1);
    CHECK(only(rows).fastest.empty());
    CHECK_THAT(only(rows).sentences[2], Contains("not timed in turns"));
    // What is beyond the error does not count.
    rows.back() = row_of("later", 1.3, 1'000'000, {1, 1, 1}, 1);
    CHECK(only(rows).fastest == Indices{1});
}

TEST_CASE("a target is the error, with an outcome for each") {
    std::vector<Row> rows = sample();
    rows[1].setting.target_delta = nonconformity_of_factor(1.2);
    rows[2].setting.target_delta = nonconformity_of_factor(1.05);
    const auto all = outcomes(rows, tree_rows());
    REQUIRE(all.size() == 2);
    CHECK(all[0].factor == Approx(1.05));
    CHECK(all[0].is_asked);
    CHECK(all[0].within == Indices{3});
    CHECK(all[1].within == Indices{1, 3});  // at the target itself too
    CHECK_THAT(all[1].sentences[0], Contains("within 1.2x of") && !Contains("by default"));
}

TEST_CASE("of tensors, delta allows more along one direction, and is a condition of its own") {
    std::vector<Row> rows = sample();
    for (Row& row : rows) row.setting.target_delta = 0.1;
    rows[1].values["within_fine_max"] = 1.36;  // along one direction
    rows[1].values["delta_R_fine_max"] = 0.096;
    rows[2].values["within_fine_max"] = 1.3;
    rows[2].values["delta_R_fine_max"] = 0.11;
    const Outcome outcome = only(rows);
    CHECK(outcome.factor == Approx(largest_factor_along(0.1)));
    CHECK(outcome.within == Indices{1, 3});
    CHECK_THAT(outcome.sentences[0], Contains("within 1.37x of") && Contains(", and δ <= 0.1:"));
    for (Row& row : rows) row.setting.within = 1.32;
    CHECK(only(rows).factor == 1.32);
    CHECK(only(rows).within == Indices{2, 3});
}

TEST_CASE("it is said when nothing is within the error, and what is closest") {
    std::vector<Row> rows{sample()[0]};
    CHECK(only(rows).within.empty());
    REQUIRE(only(rows).sentences.size() == 2);
    CHECK_THAT(only(rows).sentences[0], Contains("No structure") && Contains("1.25x"));
    CHECK_THAT(only(rows).sentences[1], Contains("coarse (0.1 MB, 5.0 ns") && Contains("1.600x") &&
                                            Contains("--within 1.25 adapts trees"));
    rows[0].setting.reference = &published_sphere();
    CHECK_THAT(only(rows).sentences[1], !Contains("adapts trees"));
    rows[0].setting.target_delta = 0.1;
    CHECK_THAT(only(rows).sentences[1], Contains("remarks of the rows"));
    rows[0].values["within_fine_max"] = std::numeric_limits<double>::infinity();
    CHECK_THAT(only(rows).sentences[1], Contains("All errors are infinite"));
    rows[0].values.clear();
    rows[0].error = "failed";
    CHECK(outcomes(rows, tree_rows()).empty());
    CHECK(outcome_text(rows, tree_rows()).empty());
}

TEST_CASE("each work has an outcome of its own, under its name") {
    std::vector<Row> rows = sample();
    rows[3].setting.g_r = 1.5;
    const auto all = outcomes(rows, tree_rows());
    REQUIRE(all.size() == 2);
    CHECK(all[0].within == Indices{1, 2});
    CHECK(all[1].within == Indices{3});
    const std::string text = outcome_text(rows, tree_rows());
    CHECK_THAT(text, Contains("\nWhich structure to take: rho 1, ") && Contains("g_r 1.5") &&
                         Contains("\nSmallest: exact (5 MB"));
    const auto json = to_json(all[0]);
    CHECK(json["smallest"] == Json{2});
    CHECK(json["measured"] == 3);
}

}  // namespace controlspace::outcome_test
