// SPDX-License-Identifier: Apache-2.0
#include "geometry/random_fractions.h"

#include <catch2/catch.hpp>

namespace controlspace::random_fractions_test {

TEST_CASE("fractions are the upper 53 bits of the standard's engine") {
    // Its 10000th number from seed 5489 is given by the C++ standard, [rand.predef].
    RandomFractions fraction(5489);
    for (int i = 1; i < 10000; ++i) fraction();
    CHECK(fraction() == static_cast<double>(9981545732273789042u >> 11) / 9007199254740992.0);
}

TEST_CASE("fractions fill [0, 1) evenly") {
    RandomFractions fraction(3);
    constexpr int n = 100000;
    int tenths[10] = {};
    for (int i = 0; i < n; ++i) {
        const double x = fraction();
        REQUIRE((x >= 0 && x < 1));
        ++tenths[static_cast<int>(10 * x)];
    }
    for (const int count : tenths) CHECK(std::abs(count - n / 10) < 5 * 95);  // 95: deviation
}

}  // namespace controlspace::random_fractions_test
