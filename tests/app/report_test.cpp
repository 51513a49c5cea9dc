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
    CHECK(page.find(" src=\"") == page.find(" src=\"data:image/svg+xml;base64,"));
    // Where it is from, a verdict, a measure.
    CHECK_THAT(page, Contains("compare --as-published --structures K_L,K_oL --splits s_M"));
    CHECK_THAT(page, Contains("Of the conclusions that the paper's tables suggest"));
    CHECK_THAT(page, Contains("All measures: rho 1"));
    for (const char* name : {"pareto-01", "pareto-04", "paper-01", "access-01"}) {
        CAPTURE(name);
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
