// SPDX-License-Identifier: Apache-2.0
#include "cones/length_queue.h"

#include <catch2/catch.hpp>
#include <cmath>

#include "metric/draw.h"

namespace controlspace::length_queue_test {

TEST_CASE("What waits comes out bucket by bucket, all of it and in their order") {
    Draw draw(1);
    LengthQueue queue;
    for (const double range : {1.0, 1.01, 10.0, 1e12}) {
        queue.reset(0.5, 0.5 * range);
        std::vector<double> lengths;
        for (std::uint32_t i = 0; i < 1000; ++i) {
            lengths.push_back(0.5 * std::pow(range, draw.uniform(0, 1)));
            queue.push(lengths.back(), i, 2 * i);
        }
        double longest_before = 0;
        std::size_t count = 0;
        while (queue.advance()) {
            double shortest = 1e300;
            double longest = 0;
            while (queue.has_more()) {
                const auto taken = queue.take();
                REQUIRE(taken.length == lengths[taken.rank]);
                REQUIRE(taken.place == 2 * taken.rank);
                shortest = std::min(shortest, taken.length);
                longest = std::max(longest, taken.length);
                ++count;
            }
            REQUIRE(shortest > longest_before);
            REQUIRE(longest <= shortest * (1 + 1.0 / 64));
            longest_before = longest;
        }
        CHECK(count == lengths.size());
    }
}

TEST_CASE("What comes in late goes to the present bucket, what is too long to the last") {
    LengthQueue queue;
    queue.reset(1, 100);
    queue.push(50, 0, 0);
    queue.push(1e9, 1, 0);
    REQUIRE(queue.advance());
    queue.push(2, 2, 0);
    CHECK(queue.take().rank == 2);
    CHECK(queue.take().rank == 0);
    CHECK_FALSE(queue.has_more());
    REQUIRE(queue.advance());
    CHECK(queue.take().rank == 1);
    CHECK_FALSE(queue.advance());
}

TEST_CASE("Of equal lengths the lower rank comes first") {
    const LengthQueue::Waiting a{1, 3, 0, 0};
    CHECK(a < LengthQueue::Waiting{1, 4, 0, 0});
    CHECK_FALSE(a < LengthQueue::Waiting{1, 2, 0, 0});
    CHECK(a < LengthQueue::Waiting{2, 2, 0, 0});
}

}  // namespace controlspace::length_queue_test
