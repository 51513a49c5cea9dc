// SPDX-License-Identifier: Apache-2.0
#include <catch2/catch.hpp>

#include "controlspace/error.h"
#include "controlspace/study/results.h"
#include "study/sample_rows.h"

namespace controlspace::resume_test {

using Catch::Matchers::Contains;

namespace {

Provenance some_program() {
    Provenance p;
    p.version = "1.2.3";
    p.commit = "abc";
    p.cpu = "some processor";
    return p;
}

/// A study of three cases, of which two were finished.
struct Interrupted {
    std::vector<Case> cases{Case{}, published_case(), Case{.structure = "K_oL"}};
    StoredResults earlier{
        some_program(), Study{}, {sample_row(cases[0]), sample_row(cases[1])}, false};

    std::vector<Row> go_on(const Study& study = {}, const Provenance& now = some_program()) const {
        return rows_to_go_on_from(earlier, study, cases, now);
    }
};

}  // namespace

TEST_CASE("a run goes on after the cases that were finished") {
    Interrupted run;
    const auto rows = run.go_on();
    REQUIRE(rows.size() == 2);
    CHECK(rows[1].setting == run.cases[1]);
    run.earlier.rows.clear();
    CHECK(run.go_on().empty());
}

TEST_CASE("failed cases are finished too, and so are those that found voxels themselves") {
    Interrupted run;
    run.earlier.rows[0].values.clear();
    run.earlier.rows[0].error = "out of memory";
    run.cases[1].equal_delta = 0.1;
    run.earlier.rows[1].setting.equal_delta = 0.1;
    run.earlier.rows[1].setting.voxel = 0.037;
    CHECK(run.go_on().size() == 2);
    run.cases[1].equal_delta = run.earlier.rows[1].setting.equal_delta = {};
    CHECK_THROWS_WITH(run.go_on(), Contains("row 2 is K_L s_L"));
}

TEST_CASE("name, folder and threads may change when a run goes on, and nothing else") {
    const Interrupted run;
    Study study;
    study.name = "another";
    study.output = "elsewhere";
    study.threads = 1;
    CHECK(run.go_on(study).size() == 2);
    study.seed = 2;
    CHECK_THROWS_WITH(run.go_on(study), Contains("seed differs"));
}

TEST_CASE("what must not be mixed does not go on") {
    Interrupted run;
    Provenance now = some_program();
    now.commit = "def";
    CHECK_THROWS_WITH(run.go_on({}, now), Contains("1.2.3 (commit abc)") && Contains("commit def"));
    now = some_program();
    now.cpu = "another";
    CHECK_THROWS_WITH(run.go_on({}, now), Contains("the processor"));
    now = some_program();
    now.flags = "-O0";
    CHECK_THROWS_WITH(run.go_on({}, now), Contains("the compiler"));

    run.earlier.complete = true;
    CHECK_THROWS_WITH(run.go_on(), Contains("2 cases, and this study has 3"));
    run.earlier.rows.push_back(sample_row(run.cases[2]));
    CHECK_THROWS_WITH(run.go_on(), Contains("nothing is left"));
    run.earlier.rows.pop_back();
    run.earlier.complete = false;
    std::swap(run.cases[0], run.cases[2]);
    CHECK_THROWS_WITH(run.go_on(), Contains("row 1 is K_L") && Contains("no case 1"));
    run.cases.resize(1);
    run.cases[0] = Case{};
    CHECK_THROWS_WITH(run.go_on(), Contains("row 2"));
}

}  // namespace controlspace::resume_test
