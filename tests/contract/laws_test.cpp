// SPDX-License-Identifier: Apache-2.0
// What a field does when its sources and its domain are scaled, moved or turned together.
#include <catch2/catch.hpp>
#include <cmath>

#include "contract/structure_case.h"
#include "controlspace/measure/access_time.h"
#include "controlspace/metric/nonconformity.h"
#include "editable_space.h"

namespace controlspace::laws_test {
namespace {

// Rounded to a multiple of 2^-16: moved by whole numbers without rounding.
Point rounded(const Point& x) { return (x.array() * 65536).round() / 65536; }

Work rounded_box() {
    Work work = GENERATE(oblong_box(), flat_box());
    work.domain = {rounded(work.domain.low), rounded(work.domain.high)};
    for (PointSource& source : work.sources) source.position = rounded(source.position);
    return work;
}

// Largest δ between a field that is changed, and the field of changed sources in a changed domain.
template <class Change, class ChangeMetric>
double largest_difference(const CatalogueEntry& structure, const Work& work, const Change& change,
                          const ChangeMetric& change_metric) {
    Work changed{work.name, {}, {change(work.domain.low), change(work.domain.high)}};
    for (const PointSource& source : work.sources) {
        changed.sources.push_back(
            {change(source.position), change_metric(source.metric), source.growth});
    }
    const auto original = work.graded(structure);
    const auto other = changed.graded(structure);
    double largest = 0;
    for (const Point& p : random_points(work.domain, 1000, 6)) {
        const Point x = rounded(p);
        largest = std::max(largest, nonconformity(sample_at(*other, change(x)),
                                                  change_metric(sample_at(*original, x))));
    }
    return largest;
}

}  // namespace

STRUCTURE_CASE(does_not_round, "twice as large, a field requests twice the lengths") {
    const auto twice = [](const auto& x) { return std::decay_t<decltype(x)>(2 * x); };
    const auto doubled = [](const Metric& m) { return 2 * m; };
    CHECK(largest_difference(structure, rounded_box(), twice, doubled) < 1e-9);
}

STRUCTURE_CASE(does_not_round, "moved, a field requests the same") {
    const auto moved = [](const Point& x) { return Point(x + Vector(-1024, 256, 64)); };
    const auto same = [](const Metric& m) { return m; };
    CHECK(largest_difference(structure, rounded_box(), moved, same) < 1e-9);
}

// Leaves that keep sources choose them in the order of leaves, which changes with the axes.
STRUCTURE_CASE(keeps_node_values, "with its axes exchanged, a field requests the same") {
    const auto turned = [](const Point& x) { return Point(x[1], x[2], x[0]); };
    const auto metric = [](const Metric& m) { return Metric{m.yy, m.zz, m.xx, m.yz, m.xy, m.xz}; };
    CHECK(largest_difference(structure, rounded_box(), turned, metric) < 1e-9);
}

}  // namespace controlspace::laws_test
