// SPDX-License-Identifier: Apache-2.0
// The structure of brute_force.h over 100 sources answers what `direct`, which searches them, does.
#include <controlspace/baselines/catalogue.h>
#include <controlspace/metric/nonconformity.h>
#include <controlspace/sources/sampled_surfaces.h>

#include "brute_force.h"
#include "check.h"

int main() {
    std::vector<PointSource> sources = sample_sphere({.h = 0.05, .rho = 2});
    sources.resize(100);
    const SpaceOptions options{.domain = {Point(-1, -1, -1), Point(1, 1, 1)}};
    const auto made = [&](const CatalogueEntry& row) {
        const auto builder = row.make(options);
        builder->insert(sources);
        builder->grade({.ratio = 1.25});
        return builder->build();
    };
    const auto mine = made(brute_force_row());
    const auto direct = made(*find_entry(structures(), "direct"));
    double largest = 0;
    for (int i = 0; i < 1000; ++i) {
        const Point x(0.0021 * i - 1, 0.8 - 0.0013 * i, 0.001 * (i % 7));
        largest = std::max(largest, nonconformity(sample_at(*mine, x), sample_at(*direct, x)));
    }
    check(largest < 1e-6, "the answers are those of `direct`");
    check(mine->footprint().control_nodes == 100, "its footprint is its own");
    return failures;
}
