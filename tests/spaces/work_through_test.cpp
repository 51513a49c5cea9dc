// SPDX-License-Identifier: Apache-2.0
#include "trees/topology/work_through.h"

#include <algorithm>
#include <atomic>
#include <catch2/catch.hpp>
#include <vector>

namespace controlspace::work_through_test {

TEST_CASE("all items of a walk are worked upon once, none before what handed it on", "[threads]") {
    // Item i is handed on by item (i - 1) / children: a tree, and a chain.
    const std::size_t children = GENERATE(2, 1);
    constexpr std::size_t items = 20'001;
    std::vector<std::atomic<int>> visits(items);
    std::atomic<int> too_early = 0;
    work_through(std::size_t{0}, [&](std::size_t item, auto&& next) {
        ++visits[item];
        if (item > 0 && visits[(item - 1) / children] == 0) ++too_early;
        for (std::size_t c = 1; c <= children; ++c) {
            if (children * item + c < items) next(children * item + c);
        }
    });
    CHECK(too_early == 0);
    CHECK(std::all_of(visits.begin(), visits.end(), [](const auto& n) { return n == 1; }));
}

}  // namespace controlspace::work_through_test
