// SPDX-License-Identifier: Apache-2.0
#include "geometry/large_pages.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cstddef>
#include <numeric>
#include <vector>

namespace controlspace::large_pages_test {

TEST_CASE("a large array is the same with another capacity") {
    std::vector<int> array(40'000'000);  // three pieces
    std::iota(array.begin(), array.end(), 7);
    std::vector<int> same = array;
    reallocate(array, array.size() + 1000);
    CHECK(array.capacity() == same.size() + 1000);
    CHECK((array == same));
    reallocate(array, array.size());
    CHECK(array.capacity() == same.size());
    CHECK((array == same));
}

TEST_CASE("memory is given back but for the pages at its ends") {
    constexpr std::size_t page = 4096;
    std::vector<char> array(100 * page, 'x');
    constexpr std::size_t first = 10 * page + 1;
    give_back(&array[first], 30 * page);
    const auto is_lost = [](char c) { return c == 0; };
    const auto lost = static_cast<std::size_t>(std::ranges::count_if(array, is_lost));
    CHECK(lost <= 30 * page);
    CHECK(lost >= 29 * page);
    CHECK(std::none_of(array.begin(), array.begin() + first, is_lost));
    CHECK(std::none_of(array.begin() + first + 30 * page, array.end(), is_lost));
}

}  // namespace controlspace::large_pages_test
