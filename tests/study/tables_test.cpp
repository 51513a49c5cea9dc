#include "study/tables.h"

#include <catch2/catch.hpp>

#include "study/paper.h"
#include "study/sample_rows.h"

using namespace controlspace;
using Catch::Matchers::Contains;

namespace {

/// The cell of `structure`, `split` under `column`.
std::string cell(const TextTable& table, const std::string& structure, const std::string& split,
                 const std::string& column) {
    for (const auto& row : table.rows) {
        if (row[0] != structure || row[1] != split) continue;
        for (std::size_t j = 0; j < table.columns.size(); ++j) {
            if (table.columns[j].header == column) return row[j];
        }
    }
    return "no such cell";
}

/// Every case of the paper's tables, with sizes and times that differ.
std::vector<Row> published_rows() {
    std::vector<Row> rows;
    for (const PaperRow& paper : paper_rows()) {
        Case c = published_case();
        c.structure = paper.structure;
        c.split = paper.split;
        c.sources.rho = paper.rho;
        c.tau = paper.tau;
        c.max_depth = paper.split ? 42 : 14;
        rows.push_back(sample_row(c));
        rows.back().measures->insert_s = static_cast<double>(rows.size());
        rows.back().measures->gradation_s = 0;
    }
    return rows;
}

}  // namespace

TEST_CASE("the paper's values stand in the right cells") {
    const auto tables = paper_comparison(Study{}, published_rows());
    REQUIRE(tables.size() == 5);
    for (const TextTable& table : tables) {
        CHECK(table.rows.size() == 12);
        CHECK(table.columns.size() == 8);
    }
    // Jurczyk & Głut, Tables 1, 2, 3, 4.
    CHECK(cell(tables[0], "K_L", "s_G", "ρ 0.2 τ 0.2") == "17.07 / 341.1");
    CHECK(cell(tables[0], "K_oLB", "", "ρ 1 τ 0.5") == "17.07 / 599.33");
    CHECK(cell(tables[1], "K_oV", "", "ρ 1 τ 1") == "1.23");
    CHECK_THAT(cell(tables[2], "K_V", "s_L", "ρ 0.2 τ 1"), Contains("/ 13.64 ("));
    CHECK_THAT(cell(tables[3], "K_Li", "s_M", "ρ 0.2 τ 0.5"), Contains("51 (1) / 14.07 (12)"));
    CHECK(cell(tables[4], "K_oV", "", "ρ 1 τ 0.2") == "1.78 / 1.04");
    for (const Row& row : published_rows()) {
        const PaperRow& paper = *paper_row(row.setting);
        std::ostringstream printed;
        printed << "1.78 / " << paper.delta_r_max;
        std::ostringstream column;
        column << "ρ " << paper.rho << " τ " << paper.tau;
        CHECK(cell(tables[4], paper.structure,
                   !paper.split                        ? ""
                   : *paper.split == SplitRule::middle ? "s_L"
                   : *paper.split == SplitRule::golden ? "s_G"
                                                       : "s_M",
                   column.str()) == printed.str());
    }
}

TEST_CASE("times are compared by rank in their column") {
    std::vector<Row> rows;
    for (const auto& [split, seconds] :
         {std::pair{SplitRule::middle, 5.0}, {SplitRule::golden, 7.0}, {SplitRule::metric, 6.0}}) {
        Case c = published_case();
        c.split = split;
        rows.push_back(sample_row(c));
        rows.back().measures->insert_s = seconds;
        rows.back().measures->gradation_s = 0;
    }
    const auto tables = paper_comparison(Study{}, rows);
    // Paper's Table 2, K_L: 6.38, 2.39, 1.41.
    CHECK(cell(tables[2], "K_L", "s_L", "ρ 1 τ 1") == "5 (1) / 6.38 (3)");
    CHECK(cell(tables[2], "K_L", "s_G", "ρ 1 τ 1") == "7 (3) / 2.39 (2)");
    CHECK(cell(tables[2], "K_L", "s_M", "ρ 1 τ 1") == "6 (2) / 1.41 (1)");
}

TEST_CASE("only what was run as published is set beside the paper") {
    Case defaults = published_case();
    defaults.law = GradationLaw::cone;
    CHECK(paper_comparison(Study{}, std::vector{sample_row(defaults)}).empty());
    Case other = published_case();
    other.tau = 0.3;
    CHECK(paper_comparison(Study{}, std::vector{sample_row(other)}).empty());
    Study study;
    study.domain = Box{Point::Constant(-2), Point::Constant(2)};
    CHECK(paper_comparison(study, std::vector{sample_row(published_case())}).empty());
}

TEST_CASE("every row is in one table of measures that names its mode") {
    Case defaults = published_case();
    defaults.law = GradationLaw::cone;
    defaults.schedule = GradationSchedule::queue;
    defaults.reference = ReferenceKind::exact;
    Case grid = defaults;
    grid.structure = "uniform-nearest";
    grid.split.reset();
    std::vector<Row> rows{sample_row(defaults), sample_row(published_case()), sample_row(grid)};
    rows[2].measures.reset();
    rows[2].error = "no memory";
    const auto tables = measure_tables(rows);
    REQUIRE(tables.size() == 2);
    CHECK_THAT(tables[0].title, Contains("tau 1") && Contains("cone law, queue, exact reference"));
    CHECK_THAT(tables[1].title, Contains("mean-length law, passes, published-sphere reference"));
    CHECK(tables[0].rows.size() == 2);
    CHECK(cell(tables[0], "K_L", "s_L", "MB") == "1.23");
    CHECK(cell(tables[0], "K_L", "s_L", "leaves") == "103");
    CHECK(cell(tables[0], "K_L", "s_L", "creation s") == "1.750");
    CHECK(cell(tables[0], "K_L", "s_L", "random ns") == "51.0");
    CHECK(cell(tables[0], "K_L", "s_L", "grid ns") == "11.0");
    CHECK(cell(tables[0], "K_L", "s_L", "δ_R p99") == "0.4000");
    CHECK(cell(tables[0], "K_L", "s_L", "fine max") == "2.7800");
    CHECK(cell(tables[0], "K_L", "s_L", "fine coarser") == "7.00 %");
    CHECK(cell(tables[0], "K_L", "s_L", "worst") == "1.400");
    CHECK(cell(tables[0], "K_L", "s_L", "G left") == "1.2499");
    CHECK(cell(tables[0], "uniform-nearest", "", "remark") == "failed: no memory");
    for (const auto& table : tables) {
        for (const auto& row : table.rows) CHECK(row.size() == table.columns.size());
    }
}

TEST_CASE("a failed row does not hide the paper's value") {
    std::vector<Row> rows{sample_row(published_case())};
    rows[0].measures.reset();
    const auto tables = paper_comparison(Study{}, rows);
    CHECK(cell(tables[4], "K_L", "s_L", "ρ 1 τ 1") == "failed / 1.78");
}
