// SPDX-License-Identifier: Apache-2.0
#include <catch2/catch.hpp>

#include "peers/peers.h"

namespace controlspace::p4est_test {

TEST_CASE("a forest of p4est answers as K_oL, to the bit") {
    const Work work =
        GENERATE(oblong_box(), anisotropic_oblong_box(), flat_box(), isotropic_sphere());
    CAPTURE(work.name);
    const auto places = places_in(work, 5000);
    const auto forest = finished("p4est-octree", work);
    const auto octree = finished("K_oL", work);
    CHECK(differing(answers_at(*forest, places), answers_at(*octree, places)) == 0);
    CHECK(forest->footprint().depth == octree->footprint().depth);
    CHECK(forest->footprint().cells == octree->footprint().cells);
}

TEST_CASE("faces of leaves belong to the same side in a forest of p4est and in K_oL") {
    const Work work = isotropic_sphere();  // in [-1, 1]^3: faces are exact in floating point
    std::vector<Point> places;
    for (int i = 0; i <= 64; ++i) {
        for (int j = 0; j <= 64; ++j) {
            places.emplace_back(-1 + i / 32.0, -1 + j / 32.0, -1 + ((3 * i + 5 * j) % 65) / 32.0);
        }
    }
    CHECK(differing(answers_at(*finished("p4est-octree", work), places),
                    answers_at(*finished("K_oL", work), places)) == 0);
}

TEST_CASE("a forest of p4est is adapted as K_oL is") {
    const Work work = oblong_box();
    const auto adapted = [&](const char* id) {
        const auto builder = row_named(id).make(work.options());
        AdaptationGoal goal;
        goal.sources = work.sources;
        CHECK(builder->adapt(goal).met);
        return answers_at(*builder->build(), places_in(work));
    };
    CHECK(differing(adapted("p4est-octree"), adapted("K_oL")) == 0);
}

}  // namespace controlspace::p4est_test
