// SPDX-License-Identifier: Apache-2.0
#include <openvdb/tree/Tree.h>

#include <catch2/catch.hpp>

#include "baselines/openvdb/prune.h"

namespace controlspace::openvdb_prune_test {

TEST_CASE("leaves that are alike become tiles of the metric that all of them allow") {
    openvdb::tree::Tree4<VdbMetric, 3, 3, 2>::Type tree(VdbMetric(0));
    const Metric a{0.2, 0.3, 0.25, 0.01, -0.02, 0.03};
    const auto put = [&](const openvdb::Coord& low, const Metric& m) {
        for (int i = 0; i < 64; ++i) {
            tree.setValue(low + openvdb::Coord(i & 3, i >> 2 & 3, i >> 4), VdbMetric(m));
        }
    };
    for (const int x : {0, 4, 8}) put({x, 0, 0}, a);
    // Differ in the last entry alone, and along different directions.
    const Metric b{0.2, 0.3, 0.25, 0.01, -0.02, 0.035};
    const Metric c{0.22, 0.28, 0.25, 0.01, -0.02, 0.03};
    tree.setValue({1, 2, 3}, VdbMetric(b));
    tree.setValue({2, 2, 3}, VdbMetric(c));
    tree.setValue({5, 1, 1}, VdbMetric(0.5 * a));     // far off
    tree.setValueOff({9, 1, 1}, VdbMetric(0.5 * a));  // does not count
    prune_metrics(tree, 0.1, [](const VdbMetric& v) { return v.metric; });
    CHECK(tree.leafCount() == 1);
    for (const Metric& m : {a, b, c}) {
        const Metric tile = tree.getValue({3, 3, 3}).metric;
        CHECK(is_within(tile, 1 + 1e-12, m));
        CHECK(nonconformity(tile, m) <= 0.1);
    }
    CHECK(tree.isValueOn({3, 3, 3}));
    CHECK(tree.getValue({5, 1, 1}).metric == 0.5 * a);
    CHECK(tree.getValue({9, 1, 1}).metric == a);
}

TEST_CASE("the arithmetic of OpenVDB's values is entry by entry") {
    const VdbMetric a(Metric{1, 2, 3, 4, 5, 6});
    CHECK(VdbMetric(0) + a == a);
    CHECK((a - a) == VdbMetric(0));
    CHECK(-a == VdbMetric(Metric{-1, -2, -3, -4, -5, -6}));
    CHECK(Abs(-a) == a);
    CHECK(a * 2 == a + a);
    CHECK(VdbMetric(Metric{1, 2, 3, 4, 5, 5}) < a);
    CHECK(a > VdbMetric(1));
}

}  // namespace controlspace::openvdb_prune_test
