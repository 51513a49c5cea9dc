// End to end: `controlspace report`.
#include <catch2/catch.hpp>
#include <string>

#include "app/sandbox.h"
#include "report/markup.h"

using namespace controlspace;
using Catch::Matchers::Contains;

namespace {

const std::string quick =
    " --access-points 100 --access-repeats 3 --probe-grid 5 --fine-probe-grid 5 --quiet";

}  // namespace

TEST_CASE("a report of results: one page that needs nothing else, and its pictures") {
    const Sandbox box("report");
    const std::string cells = "compare --as-published --structures K_L,K_oL --splits s_M ";
    REQUIRE(box.run(cells + "--output out" + quick).status == 0);
    const Outcome outcome = box.run("report out");
    INFO(outcome.err);
    REQUIRE(outcome.status == 0);
    CHECK(outcome.out == "Report: out/report.html\n");
    const std::string page = file_text(box / "out" / "report.html");
    CHECK(markup_fault(page).empty());
    CHECK(page.find("http") == page.npos);
    for (auto at = page.find(" src="); at != page.npos; at = page.find(" src=", at + 1)) {
        CHECK(page.compare(at, 17, " src=\"data:image/") == 0);
    }
    // Where it is from, a verdict, a measure.
    CHECK_THAT(page, Contains("compare --as-published --structures K_L,K_oL --splits s_M"));
    CHECK_THAT(page, Contains("Of the conclusions that the paper's tables suggest"));
    CHECK_THAT(page, Contains("All measures: rho 1"));
    for (const char* name : {"pareto-01", "pareto-04", "paper-01", "access-01", "slice-01", "delta",
                             "cross-validation"}) {
        CAPTURE(name);
        CHECK_THAT(page, Contains(std::string("; report-pictures/") + name + ".svg, .png, .gp<"));
        for (const char* ending : {".svg", ".png", ".gp"}) {
            CHECK(fs::exists(box / "out" / "report-pictures" / (std::string(name) + ending)));
        }
    }
    // Again, elsewhere: the same page, and nothing else is left over.
    REQUIRE(box.run("report out --output elsewhere/new").status == 0);
    CHECK(file_text(box / "elsewhere" / "new" / "report.html") == page);
    for (const auto& entry : fs::directory_iterator(box / "elsewhere" / "new")) {
        const std::string name = entry.path().filename().string();
        CHECK((name == "report.html" || name == "report-pictures"));
    }
}

TEST_CASE("a report whose sources are gone has all but the fields, and says so") {
    const Sandbox box("report-moved");
    box.write("s.csv", "x,y,z,h\n0,0,0,0.1\n1,1,1,0.2\n");
    REQUIRE(box.run("compare --sources s.csv --structures K_oL --output out" + quick).status == 0);
    fs::remove(box / "s.csv");
    const Outcome outcome = box.run("report out");
    CHECK(outcome.status == 0);
    CHECK_THAT(outcome.err, Contains("fields are not shown: s.csv: no such file"));
    CHECK_THAT(file_text(box / "out" / "report.html"), Contains("Fields are not shown"));
    CHECK(box.run("report out --without-fields").err.empty());
}

TEST_CASE("a report of two runs says what changed") {
    const Sandbox box("report-two");
    for (const char* folder : {"before", "after"}) {
        REQUIRE(box.run("compare --structures K_oL,direct --sources sphere --output " +
                        std::string(folder) + quick)
                    .status == 0);
    }
    const Outcome outcome = box.run("report before after --output both --without-fields");
    INFO(outcome.err);
    REQUIRE(outcome.status == 0);
    const std::string page = file_text(box / "both" / "report.html");
    CHECK(markup_fault(page).empty());
    CHECK_THAT(page, Contains("2 rows of 2 have the same setting as one of 2"));
    // Memory and errors are the same each time.
    CHECK_THAT(page, Contains("<td class=\"left\">memory</td><td>0 smaller</td><td>2</td>"));
    for (const char* name : {"2-change-01.svg", "1-access-01.png", "2-access-01.png"}) {
        CHECK(fs::exists(box / "both" / "report-pictures" / name));
    }
}

TEST_CASE("a report that cannot be written is refused, and leaves nothing behind") {
    const Sandbox box("report-refused");
    REQUIRE(box.run("compare --structures K_oL --sources sphere --output out" + quick).status == 0);
    check_refused(box.run("report none"), "none");
    check_refused(box.run("report"), "RESULTS");
    check_refused(box.run("report out", "export PATH=/nowhere; "), "gnuplot-nox");
    check_refused(box.run("report out --output out/results.json/x"), "choose another");
    fs::create_directories(box / "empty");
    check_refused(box.run("report empty"), "empty/results.json");
    box.write("empty/results.json", "{\"program\": \"controlspace\", \"schema_version\": 1}");
    check_refused(box.run("report empty"), "empty/results.json");
    CHECK_FALSE(fs::exists(box / "out" / "report-pictures"));
    fs::create_symlink("/dev/full", box / "out" / "report.html");
    check_refused(box.run("report out"), "report.html");
    std::size_t entries = 0;
    for ([[maybe_unused]] const auto& entry : fs::directory_iterator(box / "out")) ++entries;
    CHECK(entries == 5);  // what `compare` wrote, and the link
}
