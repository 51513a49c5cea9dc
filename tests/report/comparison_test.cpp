// Two runs beside each other.
#include "report/comparison.h"

#include <catch2/catch.hpp>

#include "study/sample_rows.h"

using namespace controlspace;
using Catch::Matchers::Contains;

namespace {

std::vector<Row> rows() {
    return {sample_row({.structure = "K_oL"}), sample_row({.structure = "K_oV"}),
            sample_row({.structure = "K_oL", .tau = 0.5})};
}

}  // namespace

TEST_CASE("rows are paired by setting and number of sources, each once") {
    const auto before = rows();
    std::vector<Row> after{before[2], before[0], before[0], before[1]};
    after[3].sources = 5;
    const auto pairs = row_pairs(before, after);
    REQUIRE(pairs.size() == 2);
    CHECK(pairs[0].before == &before[0]);
    CHECK(pairs[0].after == &after[1]);
    CHECK(pairs[1].after == &after[0]);
    after[1].measures.reset();
    CHECK(row_pairs(before, after)[0].after == &after[2]);
    CHECK(row_pairs(before, {}).empty());
}

TEST_CASE("a run compared with itself has not changed") {
    const auto same = rows();
    const auto pairs = row_pairs(same, same);
    for (const auto& row : change_counts(pairs).rows) {
        CAPTURE(row[0]);
        CHECK(row[1].front() == '0');
        CHECK(row[2] == "3");
        CHECK(row[3].front() == '0');
        CHECK(row[4] == "0");
    }
    CHECK(change_tables(pairs).size() == 2);
}

TEST_CASE("a ratio's band comes from opposite quartiles") {
    const AccessTime before{{100, 110, 120, 130, 140}, 0};  // quartiles 110, 120, 130
    const AccessTime after{{50, 55, 60, 65, 70}, 0};        // quartiles 55, 60, 65
    const NoisyRatio ratio = access_ratio(before, after);
    CHECK(ratio.value == Approx(0.5));
    CHECK(ratio.low == Approx(55.0 / 130));
    CHECK(ratio.high == Approx(65.0 / 110));
    CHECK_FALSE(ratio.is_within_noise());
    // The way back is the inverse.
    const NoisyRatio back = access_ratio(after, before);
    CHECK(back.low == Approx(1 / ratio.high));
    CHECK(back.high == Approx(1 / ratio.low));
    CHECK(access_ratio(before, {{105, 115, 125}, 0}).is_within_noise());
}

TEST_CASE("studies that measure otherwise are told apart") {
    Study before, after;
    after.name = "another";
    after.output = "elsewhere";
    CHECK(differing_settings(before, after).empty());
    after.fine_probe_grid = 20;
    after.domain = Box{Point(0, 0, 0), Point(1, 1, 1)};
    CHECK(differing_settings(before, after) ==
          "domain not set, then 0, 1, 0, 1, 0, 1; fine_probe_grid 101, then 20");
}

TEST_CASE("what is faster, larger or less accurate is counted, and stands in table and picture") {
    const auto before = rows();
    auto after = rows();
    after[0].measures->access_random.samples_ns = {26, 25, 25.5};
    after[0].measures->footprint.bytes_payload += 1'230'000;
    after[0].measures->accuracy_fine.mean = 0.18;
    after[1].measures->accuracy_fine.max = 0;
    const auto pairs = row_pairs(before, after);
    const TextTable counts = change_counts(pairs);
    CHECK(counts.rows[0] ==
          std::vector<std::string>{"access, random", "1 faster", "2", "0 slower", "0"});
    CHECK(counts.rows[3][3] == "1 larger");
    CHECK(counts.rows[4][4] == "1");
    CHECK(counts.rows[5][3] == "1 less accurate");
    const auto tables = change_tables(pairs);
    REQUIRE(tables.size() == 2);
    CHECK_THAT(tables[0].rows[0][1], Contains("0.500") && Contains(" *"));
    CHECK(tables[0].rows[0][4] == "2.000");
    CHECK(tables[0].rows[1][5] == "–");
    const auto figures = change_figures(pairs, "2-", "a; b");
    REQUIRE(figures.size() == 2);
    CHECK(figures[0].name == "2-change-01");
    CHECK_THAT(figures[0].data, Contains(" 0.5 "));
    CHECK_THAT(figures[0].data, Contains(" 2 2 2\n"));
}
