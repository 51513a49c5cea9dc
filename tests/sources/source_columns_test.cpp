// SPDX-License-Identifier: Apache-2.0
#include "controlspace/sources/source_columns.h"

#include <algorithm>
#include <catch2/catch.hpp>

#include "controlspace/sources/cone.h"
#include "metric/draw.h"

namespace controlspace::source_columns_test {
namespace {

std::vector<PointSource> drawn(std::size_t count, bool tensors, bool own_growths) {
    Draw draw(1);
    std::vector<PointSource> sources(count);
    for (PointSource& source : sources) {
        for (double& x : source.position) x = draw.uniform(-1, 1);
        source.metric = tensors && draw.uniform(0, 1) < 0.5
                            ? draw.metric(0.5, 10)
                            : Metric::isotropic(draw.uniform(0.1, 1));
        if (own_growths && draw.uniform(0, 1) < 0.3) source.growth = draw.uniform(1, 2);
    }
    return sources;
}

}  // namespace

TEST_CASE("columns of sources give back what was added, in parts of any size") {
    const bool tensors = GENERATE(false, true);
    const bool own_growths = GENERATE(false, true);
    auto sources = drawn(100, false, false);  // the first tensor and ratio come late
    for (const PointSource& source : drawn(100, tensors, own_growths)) sources.push_back(source);
    SourceColumns columns;
    for (std::size_t i = 0; i < sources.size(); i += 7) {
        columns.add(std::span(sources).subspan(i, std::min<std::size_t>(7, sources.size() - i)));
    }
    CHECK(columns.are_isotropic() == !tensors);
    CHECK(columns.growths().empty() == !own_growths);
    CHECK(columns.all() == sources);
    CHECK(columns.part(95, 20) == std::vector(sources.begin() + 95, sources.begin() + 115));
    CHECK(columns.part(190, 1000) == std::vector(sources.begin() + 190, sources.end()));
    CHECK(finest_length(columns) == finest_length(sources));
    CHECK(largest_growth(columns, 1.25) == largest_growth(sources, 1.25));
}

TEST_CASE("columns of isotropic sources take 32 bytes each") {
    const auto sources = drawn(1000, false, false);
    CHECK(columns_of(sources).bytes() == 32 * sources.size());
    CHECK(columns_of(drawn(1000, true, false)).bytes() == 72 * sources.size());
    SourceColumns columns = columns_of(sources);  // lengths are given up for the first tensor
    columns.add(std::vector{PointSource{Point::Zero(), Metric{1, 2, 3, 0, 0, 0}}});
    CHECK(columns.lengths().capacity() == 0);
}

TEST_CASE("copies of columns share their memory until one of them is added to") {
    const bool tensors = GENERATE(false, true);
    const auto sources = drawn(100, tensors, true);
    const auto more = drawn(50, true, true);
    const SourceColumns first = columns_of(sources);
    SourceColumns second;
    second.add(first);
    CHECK(second.positions().data() == first.positions().data());
    second.add(columns_of(more));
    CHECK(first.all() == sources);
    auto both = sources;
    both.insert(both.end(), more.begin(), more.end());
    CHECK(second.all() == both);
    const SourceColumns third = second;
    second.add(second);
    CHECK(third.all() == both);
    CHECK(second.part(150, 150) == both);
}

TEST_CASE("columns without sources have no finest length") {
    CHECK_THROWS_WITH(finest_length(SourceColumns()), Catch::Contains("give at least one"));
}

}  // namespace controlspace::source_columns_test
