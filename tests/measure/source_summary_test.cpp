// SPDX-License-Identifier: Apache-2.0
#include "measure/source_summary.h"

#include <catch2/catch.hpp>

#include "controlspace/error.h"
#include "controlspace/sources/sampled_surfaces.h"

namespace controlspace::source_summary_test {

TEST_CASE("a few sources are summed up as by hand") {
    const std::vector<PointSource> sources{{{0, 0, 0}, Metric::isotropic(0.1)},
                                           {{1, 0, 0}, Metric::isotropic(0.4)},
                                           {{0, 2, 0}, {0.2, 0.1, 0.5, 0, 0, 0}},
                                           {{0, 2, 0}, {0.2, 0.1, 0.5, 0, 0, 0}},
                                           {{1, 0, 0}, Metric::isotropic(0.4)}};
    const SourceSummary s = summarise(sources);
    CHECK(s.count == 5);
    CHECK(s.isotropic == 3);
    CHECK(s.contradictory == 0);
    CHECK(s.extent == Box{{0, 0, 0}, {1, 2, 0}});
    CHECK(s.finest == Approx(0.1));
    CHECK(s.coarsest == Approx(0.5));
    CHECK(s.mean == Approx((0.1 + 0.4 + 0.4 + 2 * 0.8 / 3) / 5));
    CHECK(s.anisotropy == Approx(5));
    // From the first source to the second h grows by 0.3 in 1; towards the third by 4 times, over
    // 20 of the first one's lengths, and from the third to the second by less.
    CHECK(s.gradation == Approx(1.3));
}

TEST_CASE("sources at one place that ask for different sizes are counted") {
    std::vector<PointSource> sources{{{0, 0, 0}, Metric::isotropic(0.1)},
                                     {{0, 0, 0}, Metric::isotropic(0.1)},
                                     {{1, 0, 0}, Metric::isotropic(0.1)},
                                     {{1, 0, 0}, Metric::isotropic(0.2)}};
    CHECK(summarise(sources).contradictory == 2);
    CHECK(summarise(sources).gradation == 1);  // the smallest at each place
    sources[0].metric.xx = 0.2;
    CHECK(summarise(sources).contradictory == 4);
}

TEST_CASE("a million sources in two places are summed up at once") {
    std::vector<PointSource> sources(1'000'000, {{0, 0, 0}, Metric::isotropic(0.1)});
    for (std::size_t i = 0; i < sources.size(); i += 2) {
        sources[i] = {{1, 0, 0}, Metric::isotropic(0.4)};
    }
    const SourceSummary s = summarise(sources);
    CHECK(s.count == sources.size());
    CHECK(s.contradictory == 0);
    CHECK(s.gradation == Approx(1.3));
}

TEST_CASE("a sphere of equal sources asks for no gradation") {
    const SourceSummary s = summarise(sample_sphere({}));
    CHECK(s.count == 36186);
    CHECK(s.contradictory == 0);
    CHECK(s.gradation == 1);
    CHECK(s.anisotropy == 1);
}

TEST_CASE("no sources cannot be summed up") { CHECK_THROWS_AS(summarise({}), InputError); }

}  // namespace controlspace::source_summary_test
