#include "study/paper_verdicts.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "study/paper_rows.h"

using namespace controlspace;
using Catch::Matchers::Contains;

namespace {

/// The published case of `structure` at rho = tau = 1.
Case setting(const std::string& structure, std::optional<SplitRule> split = {}) {
    Case c = published_case();
    c.structure = structure;
    c.split = split;
    c.max_depth = split ? 42 : 14;
    return c;
}

Row measured(const Case& c, double megabytes, double delta_r) {
    Row row = sample_row(c);
    row.measures->footprint.bytes_published = static_cast<std::size_t>(megabytes * 1e6);
    row.measures->accuracy.max = delta_r;
    return row;
}

PaperEvidence evidence_of(const std::vector<Row>& rows) {
    PaperEvidence evidence;
    evidence.add(Study{}, rows);
    return evidence;
}

/// The verdict on the cell of `structure`.
CellVerdict verdict_on(const PaperEvidence& evidence, PaperTable table,
                       const std::string& structure) {
    const auto judged = judge(evidence, table);
    const auto found = std::find_if(judged.begin(), judged.end(), [&](const CellVerdict& v) {
        return v.cell.paper->structure == structure;
    });
    REQUIRE(found != judged.end());
    return *found;
}

Study stretched_box() {
    Study study;
    study.domain = Box{Point(-1.000000001, -1, -1), Point(1.000000001, 1, 1)};
    return study;
}

}  // namespace

TEST_CASE("equal to the printed digit is what rounds to it") {
    CHECK(equals_printed(17.0749, 17.07));
    CHECK(equals_printed(17.0651, 17.07));
    CHECK_FALSE(equals_printed(17.0751, 17.07));
    CHECK_FALSE(equals_printed(17.0649, 17.07));
    CHECK(equals_printed(1.7022, 1.7));  // the paper's trailing zero
    CHECK_FALSE(equals_printed(1.71, 1.7));
}

TEST_CASE("the paper's own numbers are all equal, and times are never compared") {
    const PaperEvidence evidence = evidence_of(rows_of_paper());
    REQUIRE(evidence.cells().size() == 72);
    for (const PaperTable table : paper_tables) {
        const bool time = table == PaperTable::creation || table == PaperTable::access;
        for (const CellVerdict& judged : judge(evidence, table)) {
            CHECK(judged.verdict == (time ? Verdict::not_comparable : Verdict::equal));
        }
    }
}

TEST_CASE("a difference that no experiment bears on stays unexplained") {
    // Table 1: 17.07, Table 4: 1.78.
    const auto evidence = evidence_of({measured(setting("K_L", SplitRule::middle), 17.08, 1.80)});
    for (const PaperTable table : {PaperTable::size, PaperTable::delta_r}) {
        const CellVerdict judged = verdict_on(evidence, table, "K_L");
        CHECK(judged.verdict == Verdict::unexplained);
        CHECK_THAT(judged.reason, Contains("no experiment"));
    }
}

TEST_CASE("a case that failed is a failed cell with its reason") {
    Row row = sample_row(published_case());
    row.measures.reset();
    row.error = "out of memory";
    const CellVerdict judged = verdict_on(evidence_of({row}), PaperTable::size, "K_L");
    CHECK(judged.verdict == Verdict::failed);
    CHECK(judged.reason == "out of memory");
}

TEST_CASE("balance explains K_oLB only while balance is cheap and harmless here") {
    // Table 1: 528.22 and K_oL 16.36; Table 4: 6.88.
    const Row plain = measured(setting("K_oL"), 16.36, 1.65);
    const auto verdict = [&](double size, double delta, PaperTable table) {
        return verdict_on(evidence_of({plain, measured(setting("K_oLB"), size, delta)}), table,
                          "K_oLB");
    };
    CHECK(verdict(19.43, 0.52, PaperTable::size).verdict == Verdict::explained);
    CHECK_THAT(verdict(19.43, 0.52, PaperTable::size).reason,
               Contains("1.19 times") && Contains("0.52 against its 1.65") && Contains("32.3"));
    CHECK(verdict(19.43, 0.52, PaperTable::delta_r).verdict == Verdict::explained);
    CHECK(verdict(40, 0.52, PaperTable::size).verdict == Verdict::unexplained);
    CHECK(verdict(19.43, 1.7, PaperTable::delta_r).verdict == Verdict::unexplained);
    const auto alone = evidence_of({measured(setting("K_oLB"), 19.43, 0.52)});
    CHECK(verdict_on(alone, PaperTable::size, "K_oLB").verdict == Verdict::unexplained);
}

TEST_CASE("ties explain s_G and s_M as far as cases equal but for rounding differ") {
    // Table 1: 5.27, Table 4: 6.48.
    Case near = setting("K_L", SplitRule::metric);
    near.tau = 0.999999999;
    const Row ours = measured(setting("K_L", SplitRule::metric), 5.15, 6.48);
    CHECK(verdict_on(evidence_of({ours}), PaperTable::size, "K_L").verdict == Verdict::unexplained);
    CHECK_THAT(verdict_on(evidence_of({ours}), PaperTable::size, "K_L").reason,
               Contains("not tried"));
    const auto moved = [&](double size) {
        return verdict_on(evidence_of({ours, measured(near, size, 6.48)}), PaperTable::size, "K_L");
    };
    CHECK(moved(5.30).verdict == Verdict::explained);
    CHECK(moved(5.01).verdict == Verdict::explained);
    CHECK(moved(5.25).verdict == Verdict::unexplained);
    CHECK_THAT(moved(5.25).reason, Contains("5.15 to 5.25"));

    Case far = near;
    far.tau = 0.9999;
    const auto unrelated = evidence_of({ours, measured(far, 9, 6.48)});
    CHECK(verdict_on(unrelated, PaperTable::size, "K_L").verdict == Verdict::unexplained);
}

TEST_CASE("a box that is longer by a billionth is another order of ties, and no cell") {
    // Table 4: 1.62.
    const Case golden = setting("K_L", SplitRule::golden);
    PaperEvidence evidence = evidence_of({measured(golden, 8.16, 1.66)});
    evidence.add(stretched_box(), std::vector{measured(golden, 8.19, 1.60)});
    REQUIRE(evidence.cells().size() == 1);
    CHECK(verdict_on(evidence, PaperTable::delta_r, "K_L").verdict == Verdict::explained);

    Study larger;
    larger.domain = Box{Point(-1.1, -1, -1), Point(1.1, 1, 1)};
    PaperEvidence other = evidence_of({measured(golden, 8.16, 1.66)});
    other.add(larger, std::vector{measured(golden, 8.19, 1.60)});
    CHECK(verdict_on(other, PaperTable::delta_r, "K_L").verdict == Verdict::unexplained);
}

TEST_CASE("s_L has no ties to explain it") {
    const Case middle = setting("K_L", SplitRule::middle);
    PaperEvidence evidence = evidence_of({measured(middle, 17.08, 1.78)});
    evidence.add(stretched_box(), std::vector{measured(middle, 18, 1.9)});
    CHECK(verdict_on(evidence, PaperTable::size, "K_L").verdict == Verdict::unexplained);
}

TEST_CASE("shared vertices explain a paper's tree with more nodes than places") {
    // Table 1: 42.89, Table 4: 1.79.
    const auto verdict = [](double size, double delta, PaperTable table) {
        Row row = measured(setting("K_oV"), size, delta);
        row.measures->footprint.control_nodes = 147359;
        return verdict_on(evidence_of({row}), table, "K_oV");
    };
    CHECK(verdict(31.65, 0.18, PaperTable::size).verdict == Verdict::explained);
    CHECK_THAT(verdict(31.65, 0.18, PaperTable::size).reason,
               Contains("255436 control nodes") && Contains("147359 places"));
    CHECK(verdict(31.65, 0.18, PaperTable::delta_r).verdict == Verdict::explained);
    CHECK(verdict(31.65, 1.9, PaperTable::delta_r).verdict == Verdict::unexplained);
    CHECK(verdict(42.8, 0.18, PaperTable::delta_r).verdict == Verdict::unexplained);
}

TEST_CASE("links explain K_oL as far as another choice of them moves it") {
    // Table 4: 1.83.
    const Row ours = measured(setting("K_oL"), 16.36, 1.65);
    Case queue = setting("K_oL");
    queue.schedule = GradationSchedule::queue;
    const auto verdict = [&](double with_queue) {
        return verdict_on(evidence_of({ours, measured(queue, 16.36, with_queue)}),
                          PaperTable::delta_r, "K_oL");
    };
    CHECK(verdict(1.33).verdict == Verdict::explained);
    CHECK(verdict(1.60).verdict == Verdict::unexplained);
}

TEST_CASE("scatter explains a delta_R that near densities reach, and no size") {
    // Table 1: 17.07, Table 4: 1.78.
    const auto verdict = [&](double near_delta, PaperTable table) {
        Case denser = setting("K_L", SplitRule::middle);
        denser.sources.rho = 0.99;
        return verdict_on(evidence_of({measured(setting("K_L", SplitRule::middle), 17.2, 1.80),
                                       measured(denser, 17, near_delta)}),
                          table, "K_L");
    };
    CHECK(verdict(1.62, PaperTable::delta_r).verdict == Verdict::explained);
    CHECK(verdict(1.784, PaperTable::delta_r).verdict == Verdict::explained);
    CHECK(verdict(1.79, PaperTable::delta_r).verdict == Verdict::unexplained);
    CHECK_THAT(verdict(1.79, PaperTable::delta_r).reason, Contains("1.79 to 1.80"));
    CHECK(verdict(1.62, PaperTable::size).verdict == Verdict::unexplained);
}

TEST_CASE("exact golden sections are another choice among almost equal edges") {
    // Table 4: 1.62.
    const auto evidence =
        evidence_of({measured(setting("K_L", SplitRule::golden), 8.16, 1.66),
                     measured(setting("K_L", SplitRule::exact_golden), 8.4, 1.6)});
    REQUIRE(evidence.cells().size() == 1);
    CHECK(verdict_on(evidence, PaperTable::delta_r, "K_L").verdict == Verdict::explained);
}

TEST_CASE("every box that is longer by a billionth counts, with the same setting too") {
    const Case golden = setting("K_L", SplitRule::golden);
    PaperEvidence evidence = evidence_of({measured(golden, 8.16, 1.66)});
    Study other = stretched_box();
    other.domain->high.z() += 1e-9;
    evidence.add(stretched_box(), std::vector{measured(golden, 8.2, 1.67)});
    evidence.add(other, std::vector{measured(golden, 8.2, 1.5)});
    CHECK(evidence.near_ties(golden).size() == 2);
}
