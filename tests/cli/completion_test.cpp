// SPDX-License-Identifier: Apache-2.0
// The completion of bash, asked as bash asks it.
#include "cli/sandbox.h"

namespace controlspace::completion_test {

using Catch::Matchers::Contains;

namespace {

/// What bash offers for the last of `words`, a blank between two.
std::string offered(const std::string& words) {
    const Sandbox box("completion");
    box.write("ask.sh", "source '" CONTROLSPACE_COMPLETION
                        "'\n"
                        "COMP_WORDS=('" CONTROLSPACE_APP
                        "' \"$@\"); COMP_CWORD=$#\n"
                        "_controlspace; echo \"${COMPREPLY[*]}\"\n");
    const Outcome outcome = box.run("--version", "bash ask.sh " + words + " >offered; ");
    CHECK(outcome.status == 0);
    const std::string text = file_text(box / "offered");
    return text.substr(0, text.find('\n'));
}

}  // namespace

TEST_CASE("commands, options and values are completed as the program names them") {
    CHECK(offered("compa") == "compare");
    CHECK(offered("--v") == "--version");
    CHECK(offered("compare --sched") == "--schedule");
    CHECK(offered("compare --splits s_M") == "s_M");
    CHECK_THAT(offered("compare --law ''"), Contains("cone") && Contains("mean-length"));
    CHECK(offered("compare --quiet --sched") == "--schedule");
    CHECK_THAT(offered("compare -"), Contains("--help") && Contains("--dry-run"));
}

TEST_CASE("each item of a list is completed") {
    CHECK(offered("compare --structures K_L,K_oLB") == "K_L,K_oLB");
}

TEST_CASE("where files are expected, nothing is offered in their place") {
    CHECK(offered("compare study").empty());
    CHECK(offered("compare --output res").empty());
}

}  // namespace controlspace::completion_test
