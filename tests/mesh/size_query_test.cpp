// SPDX-License-Identifier: Apache-2.0
#include "mesh/size_query.h"

#include <catch2/catch.hpp>
#include <thread>
#include <vector>

#include "controlspace/fields/formula_field.h"
#include "mesh/estimate.h"
#include "mesh/fixtures.h"
#include "sources/files.h"

namespace controlspace::size_query_test {

using Catch::Matchers::Contains;

namespace {

const Box box{Point(10, 20, 30), Point(14, 22, 31)};

}  // namespace

TEST_CASE("a frame leads into the domain, to its very corners") {
    const UnitFrame frame(box);
    CHECK(frame.edges() == Vector(1, 0.5, 0.25));
    CHECK(frame.to_domain(0, 0, 0) == box.low);
    CHECK(frame.to_domain(1, 0.5, 0.25) == box.high);
    CHECK(frame.to_domain(0.5, 0.25, 0.125) == Point(12, 21, 30.5));
    CHECK(box.contains(frame.to_domain(1.0000001, -1e-7, 0.25)));
}

TEST_CASE("sizes are the smallest lengths in the frame, times the factor") {
    const FormulaField field([](const Point& p) {
        return p.x() < 12 ? Metric::isotropic(p.y()) : Metric{3, 2, 8, 0, 0, 0};
    });
    SizeQuery query(field, UnitFrame(box), 0.5);
    CHECK(query(0, 0.25, 0) == Approx(0.5 * 21 / 4));
    CHECK_FALSE(query.anisotropic());
    CHECK(query(0.75, 0.25, 0) == Approx(0.5 * 2 / 4));
    CHECK(query.anisotropic());
    CHECK(query.count() == 2);
    CHECK_NOTHROW(query.rethrow_failure());
}

TEST_CASE("many threads may ask, and the first failure is kept", "[threads]") {
    const FormulaField field([](const Point& p) {
        if (p.x() > 13) throw InputError("beyond 13");
        return Metric::isotropic(1);
    });
    SizeQuery query(field, UnitFrame(box), 1);
    std::vector<std::thread> threads;
    for (int t = 0; t < 4; ++t) {
        threads.emplace_back([&] {
            for (int i = 0; i < 1000; ++i) query(0.001 * i, 0, 0);
        });
    }
    for (std::thread& thread : threads) thread.join();
    CHECK_THAT(error_of([&] { query.rethrow_failure(); }), Contains("beyond 13"));
    CHECK(query(0, 0, 0) == 1);
}

TEST_CASE("a failure of any kind is thrown again as it was") {
    struct OwnError {};
    const FormulaField field([](const Point&) -> Metric { throw OwnError{}; });
    SizeQuery query(field, UnitFrame(box), 1);
    CHECK(query(0, 0, 0) == 1);
    CHECK_THROWS_AS(query.rethrow_failure(), OwnError);
}

TEST_CASE("tetrahedra are estimated from the volumes that metrics ask for") {
    const FormulaField field([](const Point&) { return Metric{0.1, 0.2, 0.4, 0, 0, 0}; });
    // Regular ones of edge 1 have a volume of 1 / (6 sqrt 2).
    CHECK(estimated_tets(box, field) == Approx(8 * 6 * std::sqrt(2.0) / (0.1 * 0.2 * 0.4)));
    CHECK_NOTHROW(require_few_tets(box, field, 8486));
    CHECK_THAT(error_of([&] { require_few_tets(box, field, 8000); }),
               Contains("8.5e+03 tetrahedra, more than 8e+03"));
    const FormulaField wrong([](const Point&) { return Metric{-1, 1, 0, 0, 0, 0}; });
    CHECK_FALSE(error_of([&] { require_few_tets(box, wrong, 8000); }).empty());
}

}  // namespace controlspace::size_query_test
