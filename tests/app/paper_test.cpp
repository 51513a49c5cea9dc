// End to end: `controlspace paper`.
#include <catch2/catch.hpp>
#include <string>

#include "app/sandbox.h"

using namespace controlspace;
using Catch::Matchers::Contains;

namespace {

/// Settings that make cases of the paper's tables short; the probes of Table 4 stay.
const std::string quick = " --access-points 100 --access-repeats 1 --fine-probe-grid 5 --quiet";

}  // namespace

TEST_CASE("the paper's tables beside ours: from results, with experiments that lie there") {
    const Sandbox box("paper");
    REQUIRE(
        box.run("compare --as-published --structures K_L,K_oL --splits s_M --output out" + quick)
            .status == 0);
    const std::string unpublished = " --structures K_oL --output other";
    REQUIRE(box.run("compare --sources sphere" + quick + unpublished).status == 0);
    fs::remove(box / "out" / "paper.md");
    const Outcome outcome = box.run("paper out");
    INFO(outcome.err);
    CHECK(outcome.status == 0);
    // Table 4, K_L s_M and K_oL: the former to the printed digit, the latter not.
    CHECK_THAT(outcome.out, Contains("Of the 4 cells of Tables 1 and 4 2 are equal"));
    CHECK_THAT(outcome.out, Contains("Every cell and experiment: out/paper.md"));
    const std::string page = file_text(box / "out" / "paper.md");
    CHECK_THAT(page, Contains("| K_L       | s_M   |   1 |   1 | 6.48 |  6.48 | equal"));
    CHECK_THAT(page, Contains("links: not tried here"));
    CHECK(lines(page) > 60);

    // The queue's row stands for all experiments; what lies there is not run again.
    REQUIRE(box.run("compare --law mean-length --schedule queue --reference published-sphere "
                    "--structures K_oL --output out/experiments" +
                    quick)
                .status == 0);
    for (const char* folder : {"tie-order-x", "tie-order-zx"}) {
        fs::copy(box / "out" / "experiments", box / "out" / folder);
    }
    const Outcome with = box.run("paper out --experiments");
    CHECK(with.status == 0);
    CHECK(with.err.empty());
    CHECK_THAT(file_text(box / "out" / "paper.md"),
               Contains("links: which leaves are compared decides"));

    check_refused(box.run("paper other"), "no row was run as the paper's tables");
    check_refused(box.run("paper out --output new"), "--output is for what is run");
    check_refused(box.run("paper out --full"), "--full is for the built-in studies");
    check_refused(box.run("paper none"), "none");
    box.write("cone.toml", "structures = 'K_oL'\n[[runs]]\n");
    check_refused(box.run("paper cone.toml"), "has no case of the paper's tables");
}

TEST_CASE("a study for the paper's page whose cases fail has its page, and status 3") {
    const Sandbox box("paper-failed");
    box.write("study.toml",
              "structures = 'K_oL'\nmax_memory = 0.001\nlaw = 'mean-length'\n"
              "schedule = 'passes'\nreference = 'published-sphere'\naccess_points = 100\n"
              "fine_probe_grid = 5\n[[runs]]\n");
    const Outcome outcome = box.run("paper study.toml --output out --quiet");
    INFO(outcome.err);
    CHECK(outcome.status == 3);
    CHECK_THAT(file_text(box / "out" / "paper.md"), Contains("| failed"));
    CHECK_THAT(outcome.out, Contains("raise tau"));
    CHECK(box.run("paper out").status == 3);
}
