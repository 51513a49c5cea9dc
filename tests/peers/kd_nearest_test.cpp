// SPDX-License-Identifier: Apache-2.0
#include <catch2/catch.hpp>
#include <limits>

#include "controlspace/input_errors.h"
#include "peers/peers.h"

namespace controlspace::kd_nearest_test {

TEST_CASE("kd-nearest of all sources is the exact field") {
    const Work work = GENERATE(oblong_box(), flat_box(), with_own_growths(oblong_box()));
    const double ratio = GENERATE(1.0, 1.25, 3.0);
    CAPTURE(work.name, ratio);
    const std::vector<Point> places = places_in(work);
    const auto exact = lengths_at(*finished("direct", work, ratio), places);
    const auto found = lengths_at(*finished("kd-nearest-all", work, ratio), places);
    for (std::size_t i = 0; i < places.size(); ++i) {
        REQUIRE(found[i] == Approx(exact[i]).epsilon(1e-12));
    }
}

TEST_CASE("kd-nearest comes to the exact field from above as it takes more sources") {
    Work work = oblong_box();
    // Few are short: elsewhere the nearest are not those that matter.
    for (std::size_t i = 0; i < work.sources.size(); ++i) {
        if (i % 40 != 0) work.sources[i].metric = Metric::isotropic(1);
    }
    const std::vector<Point> places = places_in(work);
    std::vector<double> longer(places.size(), std::numeric_limits<double>::infinity());
    double mean_before = std::numeric_limits<double>::infinity();
    for (const char* id : {"kd-nearest-1", "kd-nearest", "kd-nearest-64", "kd-nearest-all"}) {
        CAPTURE(id);
        const auto lengths = lengths_at(*finished(id, work), places);
        double mean = 0;
        for (std::size_t i = 0; i < places.size(); ++i) {
            REQUIRE(lengths[i] <= longer[i]);
            mean += lengths[i] / static_cast<double>(places.size());
        }
        CHECK(mean < mean_before);
        mean_before = mean;
        longer = lengths;
    }
}

TEST_CASE("kd-nearest answers at a source at most what it requests, duplicates or not") {
    Work work = oblong_box();
    const std::size_t count = work.sources.size();
    const auto once = work.sources;
    for (int copy = 0; copy < 20; ++copy) {
        work.sources.insert(work.sources.end(), once.begin(), once.end());
    }
    const std::string id = GENERATE("kd-nearest", "kd-nearest-1", "kd-nearest-64");
    const auto lengths = lengths_at(*finished(id, work), places_in(work, 0));
    for (std::size_t i = 0; i < count; ++i) {
        REQUIRE(lengths[i] <= work.sources[i].metric.xx * (1 + 1e-12));
    }
}

TEST_CASE("fewer sources than kd-nearest takes are all taken") {
    Work work = oblong_box();
    work.sources.resize(5);
    const std::vector<Point> places = places_in(work);
    CHECK(differing(lengths_at(*finished("kd-nearest", work), places),
                    lengths_at(*finished("kd-nearest-all", work), places)) == 0);
}

TEST_CASE("systems of lengths name the tensor that they refuse") {
    Work work = oblong_box();
    work.sources[3].metric.xy = 0.001;
    const auto builder = row_named("kd-nearest").make(work.options());
    CHECK_THROWS_WITH(builder->insert(work.sources),
                      Catch::Contains("source 3: ") && Catch::Contains("isotropic sources"));
}

TEST_CASE("systems of sources refuse a continuous field, and adapt to sources") {
    const Work work = oblong_box();
    const auto builder = row_named("kd-nearest-all").make(work.options());
    AdaptationGoal goal;
    goal.sources = work.sources;
    goal.ratio = 1.5;
    const AdaptationReport report = builder->adapt(goal);
    CHECK(report.met);
    CHECK(report.reached < 1e-6);
    goal.continuous = builder->build();
    CHECK_THROWS_AS(builder->adapt(goal), InputError);
}

}  // namespace controlspace::kd_nearest_test
