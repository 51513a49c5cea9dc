// SPDX-License-Identifier: Apache-2.0
#include "study/time_estimate.h"

#include <catch2/catch.hpp>

namespace controlspace::time_estimate_test {

TEST_CASE("time left follows sources / tau, at each structure's own pace once it is known") {
    const std::vector<Case> cases{{.structure = "a", .tau = 1},
                                  {.structure = "b", .tau = 1},
                                  {.structure = "a", .tau = 0.5},
                                  {.structure = "c", .tau = 0.25}};
    const std::vector<std::size_t> sources{100, 100, 100, 200};
    TimeEstimate estimate(cases, sources);
    CHECK_FALSE(estimate.seconds_left());
    estimate.case_finished(1);  // a: 0.01 s a unit of work, for all
    CHECK(*estimate.seconds_left() == Approx(0.01 * (100 + 200 + 800)));
    estimate.case_finished(3);  // b: 0.03; overall 0.02
    CHECK(*estimate.seconds_left() == Approx(0.01 * 200 + 0.02 * 800));
    estimate.case_finished(2);
    estimate.case_finished(9);
    CHECK(*estimate.seconds_left() == 0);
}

TEST_CASE("how far a step has come is told with its rate and the time left") {
    CHECK(part_text(12, 50, "voxels", 4) == "12 of 50 voxels, 3/s, about 0:12 left");
    CHECK(part_text(12'500'000, 50'000'000, "voxels", 5) ==
          "12.5 of 50.0 million voxels, 2.50 million/s, about 0:15 left");
    CHECK(part_text(0, 50, "voxels", 1) == "0 of 50 voxels, 0/s");
    CHECK(part_text(0, 50, "voxels", 0) == "0 of 50 voxels, 0/s");
}

TEST_CASE("a case without sources counts as one of one") {
    const std::vector<Case> cases{{.structure = "a", .tau = 1}, {.structure = "a", .tau = 0.5}};
    TimeEstimate estimate(cases, std::vector<std::size_t>{0, 0});
    estimate.case_finished(3);
    CHECK(*estimate.seconds_left() == Approx(6));
}

}  // namespace controlspace::time_estimate_test
