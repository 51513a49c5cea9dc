#include "study/paper_page.h"

#include <catch2/catch.hpp>

#include "study/paper_experiments.h"
#include "study/paper_rows.h"

using namespace controlspace;
using Catch::Matchers::Contains;

namespace {

PaperEvidence evidence_of(const std::vector<Row>& rows) {
    PaperEvidence evidence;
    evidence.add(Study{}, rows);
    return evidence;
}

const TextTable& table(const std::vector<TextTable>& tables, const std::string& part) {
    for (const TextTable& t : tables) {
        if (t.title.find(part) != std::string::npos) return t;
    }
    throw std::logic_error(part);
}

}  // namespace

TEST_CASE("ranks: the paper against itself, and with the rows of its faults turned round") {
    const TextTable same = rank_table(evidence_of(rows_of_paper()));
    REQUIRE(same.rows.size() == 10);
    REQUIRE(same.columns.size() == 9);
    for (const auto& row : same.rows) {
        for (std::size_t j = 2; j < row.size(); ++j) CHECK(row[j] == "1.00");
    }
    const auto turned = rows_of_paper([](Row& row) {
        if (row.setting.structure == "K_oLB") row.measures->accuracy.max = 0.01;
    });
    const TextTable changed = rank_table(evidence_of(turned));
    for (const std::size_t column : {2, 3}) {
        CHECK(changed.rows[6][column] != "1.00");
        CHECK(changed.rows[7][column] == "1.00");
    }
}

TEST_CASE("every entry of Table 3 is a whole number of ticks, as printed") {
    const auto tables = paper_experiments(evidence_of(rows_of_paper()));
    const TextTable& ticks = table(tables, "clock");
    REQUIRE(ticks.rows.size() == 1);
    CHECK(ticks.rows[0][0] == "72");
    CHECK(ticks.rows[0][1] == "72");
    CHECK(ticks.rows[0][4] == "1");
}

TEST_CASE("an experiment that is not at hand says so") {
    auto rows = rows_of_paper();
    const auto without = paper_experiments(evidence_of(rows));
    CHECK(table(without, "references").rows.empty());
    CHECK_THAT(table(without, "references").note, Contains("Not in these results"));
    rows.push_back(rows.front());
    rows.back().setting.reference = ReferenceKind::exact;
    rows.back().measures->accuracy.max = 1.61;
    const auto with = paper_experiments(evidence_of(rows));
    const TextTable& references = table(with, "references");
    REQUIRE(references.rows.size() == 1);
    CHECK(references.rows[0][4] == "1.78");
    CHECK(references.rows[0][5] == "1.61");
    CHECK_THAT(references.note, !Contains("Not in these results"));
    for (const TextTable& t : with) {
        for (const auto& row : t.rows) CHECK(row.size() == t.columns.size());
    }
}

TEST_CASE("the summary hides no cell that differs") {
    const auto rows = rows_of_paper([](Row& row) {
        if (row.setting == published_case()) row.measures->accuracy.max = 1.9;
        if (row.setting.structure == "K_oLB" && row.setting.tau == 0.5) {
            row.measures.reset();
            row.error = "no memory";
        }
    });
    const std::string text = paper_summary(evidence_of(rows), TableStyle::terminal);
    CHECK_THAT(text, Catch::StartsWith("Of the conclusions that the paper's tables suggest"));
    CHECK_THAT(text, Contains("Conclusions that stand"));
    CHECK_THAT(text,
               Catch::Matches(R"([^]*1\.90 +1\.78 +differs, unexplained +no experiment[^]*)"));
    CHECK_THAT(text, Contains("no memory"));
}

TEST_CASE("conclusions are sorted by what our numbers say, with where to look") {
    // As in the paper, but for balance, which is cheap and harmless.
    const auto rows = rows_of_paper([](Row& row) {
        if (row.setting.structure != "K_oLB") return;
        row.measures->accuracy.max = 0.5;
        row.measures->footprint.bytes_payload = 1'000'000;
    });
    const std::string text = paper_summary(evidence_of(rows), TableStyle::terminal);
    CHECK_THAT(text, Contains("6 stand and 2 do not"));
    const auto at = [&](const char* part) { return text.find(part); };
    CHECK(at("Conclusions that stand") < at("Interpolation buys accuracy for time."));
    CHECK(at("Interpolation buys") < at("Conclusions that do not stand"));
    CHECK(at("Conclusions that do not stand") < at("Balancing ruins memory."));
    CHECK(at("Balancing ruins memory.") < at("Conclusions that were not measured"));
    CHECK(at("Conclusions that were not measured") < at("The split s_M is poor at any depth."));
    CHECK_THAT(text, Contains("experiment: balance"));
}

TEST_CASE("the page has a line for every cell of the four tables, and where they are from") {
    const std::vector<std::string> origins{"this machine"};
    const std::string page = paper_page(evidence_of(rows_of_paper()), origins);
    CHECK_THAT(page, Contains("- this machine\n"));
    std::size_t lines = 0;
    for (const char* verdict : {"| equal ", "| not comparable "}) {
        for (std::size_t at = page.find(verdict); at != page.npos;
             at = page.find(verdict, at + 1)) {
            ++lines;
        }
    }
    CHECK(lines == 4 * 72 + 2);  // the heads of the table of counts too
    CHECK_THAT(page, Contains("None."));
}
