// The numbers of pictures are those of rows.
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <sstream>
#include <string>
#include <vector>

#include "report/pareto_figures.h"
#include "report/time_figures.h"
#include "study/sample_rows.h"

using namespace controlspace;
using Catch::Matchers::Contains;

namespace {

/// The lines of datablock `name`.
std::vector<std::string> block(const Figure& figure, const std::string& name) {
    std::istringstream text(figure.data);
    std::vector<std::string> lines;
    bool inside = false;
    for (std::string line; std::getline(text, line);) {
        if (line == "EOD") inside = false;
        if (inside) lines.push_back(line);
        if (line == "$" + name + " << EOD") inside = true;
    }
    return lines;
}

std::vector<double> numbers(const std::string& line) {
    std::istringstream text(line);
    std::vector<double> values;
    for (double value; text >> value;) values.push_back(value);
    return values;
}

/// Three structures, of which the second is beaten by the first.
std::vector<Row> rows() {
    std::vector<Row> rows{sample_row({.structure = "K_oL"}), sample_row({.structure = "K_oV"}),
                          sample_row({.structure = "direct"})};
    rows[1].measures->footprint.bytes_payload *= 2;
    rows[1].measures->access_random.samples_ns = {100.25, 300, 200.5};
    rows[2].measures->footprint.bytes_payload *= 3;
    rows[2].measures->accuracy_fine.max = 0;
    return rows;
}

}  // namespace

TEST_CASE("a front's picture holds each row's own numbers, and the front") {
    const auto all = rows();
    const auto figures = pareto_figures(all, Styles(all), "p-", "a command");
    REQUIRE(figures.size() == 4);
    CHECK(figures[0].name == "p-pareto-01");
    CHECK(figures[0].made_by == "a command");
    for (std::size_t i = 0; i < 3; ++i) {
        const auto points = block(figures[0], "points" + std::to_string(i));
        REQUIRE(points.size() == 1);
        const Measures& m = *all[i].measures;
        CHECK(numbers(points[0]) ==
              std::vector{static_cast<double>(m.footprint.bytes_total()), m.accuracy_fine.max});
        CHECK_THAT(points[0], Contains('"' + all[i].setting.structure + '"'));
    }
    const auto front = block(figures[0], "front");
    REQUIRE(front.size() == 2);
    CHECK_THAT(front[0], Contains("K_oL"));
    CHECK_THAT(front[1], Contains("direct"));
    // By access time.
    CHECK(numbers(block(figures[2], "points1")[0])[0] == 200.5);
}

TEST_CASE("the picture of access times holds all samples, and their quartiles") {
    const auto figures = access_figures(rows(), "", "a command");
    REQUIRE(figures.size() == 1);
    const auto boxes = block(figures[0], "random");
    REQUIRE(boxes.size() == 3);
    const auto second = numbers(boxes[1]);
    CHECK(std::vector(second.begin() + 1, second.end()) ==
          std::vector{100.25, 150.375, 200.5, 250.25, 300.0});
    const auto samples = block(figures[0], "random_samples");
    REQUIRE(samples.size() == 9);
    CHECK(numbers(samples[4])[1] == 300);
    CHECK(numbers(block(figures[0], "grid_samples")[0])[1] == 12);
}

TEST_CASE("creation times are drawn where the number of sources varies, and only there") {
    auto all = rows();
    CHECK(creation_figures(all, Styles(all), "", "").empty());
    all.push_back(all[0]);
    all.back().setting.sources.rho = 0.5;
    all.back().sources = 100000;
    all.back().measures->insert_s = 3;
    const auto figures = creation_figures(all, Styles(all), "", "");
    REQUIRE(figures.size() == 1);
    const auto points = block(figures[0], "points0");
    REQUIRE(points.size() == 2);
    CHECK(numbers(points[0]) == std::vector<double>{36186, 1.75});
    CHECK(numbers(points[1]) == std::vector<double>{100000, 3.25});
}

TEST_CASE("the paper's points stand beside ours, in its own units") {
    Study study;
    PaperEvidence evidence;
    const std::vector<Row> published{sample_row(published_case())};
    evidence.add(study, published);
    const auto figures = paper_figures(evidence, Styles(published), "", "");
    REQUIRE(figures.size() == 1);
    // Tables 1 and 4 of the paper, K_L s_L at rho = tau = 1: 17.07 MB and 1.78.
    CHECK(numbers(block(figures[0], "points0")[0]) ==
          std::vector<double>{17'070'000, 1.78, 17.07, 1.78});
}

TEST_CASE("rows without measures, and no rows at all, give no pictures") {
    Row failed;
    failed.error = "out of memory";
    const std::vector<Row> all{failed, failed};
    CHECK(pareto_figures(all, Styles(all), "", "").empty());
    CHECK(access_figures(all, "", "").empty());
    CHECK(creation_figures({}, Styles({}), "", "").empty());
}

TEST_CASE("an axis holds its range, with tics that the reader can place") {
    Range range;
    range.add(3);
    range.add(0.7);
    CHECK_THAT(log_axis("x", range, "time"), Contains("'1' 1, '2' 2") && Contains("label 'time'"));
    range.add(70000);
    CHECK_THAT(log_axis("x", range, ""), Contains("'1' 1, '10' 10, '100' 100"));
    range.add(0);
    range.add(-1);
    range.add(std::numeric_limits<double>::infinity());
    range.add(std::nan(""));
    CHECK(range.low == 0.7);
    CHECK(range.high == 70000);
    CHECK_THAT(log_axis("x", {}, ""), Contains("'1' 1"));
    Range single;
    single.add(5);
    CHECK_THAT(log_axis("y", single, ""), Contains("'5' 5"));
}
