// SPDX-License-Identifier: Apache-2.0
#include "study/rank_correlation.h"

#include <catch2/catch.hpp>
#include <cmath>

namespace controlspace::rank_correlation_test {

using List = std::vector<double>;

TEST_CASE("ranks count from 1, and equal values share the mean of theirs") {
    CHECK(average_ranks(List{30, 10, 20}) == List{3, 1, 2});
    CHECK(average_ranks(List{5, 6, 7, 8, 7}) == List{1, 2, 3.5, 5, 3.5});
    CHECK(average_ranks(List{2, 2, 2, 1}) == List{3, 3, 3, 1});
    CHECK(average_ranks(List{}).empty());
}

TEST_CASE("Spearman's rho by hand, without and with ties") {
    // Without ties rho = 1 - 6 sum d^2 / (n (n^2 - 1)); here d = 0, -1, 1, -1, 1.
    CHECK(*spearman(List{1, 2, 3, 4, 5}, List{10, 30, 20, 50, 40}) ==
          Approx(1 - 6.0 * 4 / (5 * 24)));
    // Ranks 1 2 3 4 5 and 1 2 3.5 5 3.5: covariance 8, variances 10 and 9.5.
    CHECK(*spearman(List{1, 2, 3, 4, 5}, List{5, 6, 7, 8, 7}) == Approx(8 / std::sqrt(95.0)));
    // Ties in both: ranks 1.5 1.5 3 4 and 1 2.5 2.5 4: covariance 3.75, variances 4.5 and 4.5.
    CHECK(*spearman(List{1, 1, 2, 3}, List{1, 2, 2, 3}) == Approx(3.75 / 4.5));
}

TEST_CASE("Spearman's rho: the same order gives 1, the reverse -1, whatever the values") {
    const List a{0.3, 1e9, 2, -7, 5};
    List b, c;
    for (const double x : a) {
        b.push_back(std::cbrt(x) + 4);
        c.push_back(-std::cbrt(x));
    }
    CHECK(*spearman(a, b) == Approx(1));
    CHECK(*spearman(a, c) == Approx(-1));
    CHECK(*spearman(List{1, 3, 2, 7}, List{4, 2, 9, 1}) ==
          Approx(*spearman(List{4, 2, 9, 1}, List{1, 3, 2, 7})));
}

TEST_CASE("no rank correlation where there is nothing to order") {
    CHECK_FALSE(spearman(List{}, List{}));
    CHECK_FALSE(spearman(List{1, 2}, List{1, 2}));
    CHECK_FALSE(spearman(List{1, 2, 3}, List{4, 4, 4}));
}

}  // namespace controlspace::rank_correlation_test
