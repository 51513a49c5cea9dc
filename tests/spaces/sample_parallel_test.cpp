// SPDX-License-Identifier: Apache-2.0
#include "controlspace/space/sample_parallel.h"

#include <tbb/global_control.h>

#include <catch2/catch.hpp>
#include <vector>

#include "case_of_each.h"
#include "controlspace/baselines/catalogue.h"
#include "controlspace/measure/access_time.h"
#include "controlspace/sources/sampled_surfaces.h"
#include "editable_space.h"

namespace controlspace::sample_parallel_test {

CASE_OF_EACH(entry, structures(),
             "a batch on many threads gets the bits of one thread, whatever its size and its place",
             "[threads]") {
    const auto threads = GENERATE(1, 2, 3);
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                    static_cast<std::size_t>(threads));
    const Box domain{Point::Constant(-1), Point::Constant(1)};
    const std::vector<PointSource> sources = sample_sphere({.h = 0.1, .rho = 2});
    const std::vector<Point> x = random_points(domain, 10003, 1);
    CAPTURE(threads);
    auto space = editable(entry.make({.domain = domain, .finest_length = finest_length(sources)}));
    space->insert(sources);
    space->grade({});
    std::vector<Metric> expected(x.size());
    space->sample(x, expected);
    for (const std::size_t n : {0u, 1u, 2048u, 2049u, 2052u, 4097u, 10000u}) {
        for (const std::size_t shift : {0u, 1u, 2u, 3u}) {
            CAPTURE(n, shift);
            const Metric untouched = Metric::isotropic(-1);
            std::vector<Metric> out(x.size(), untouched);
            sample_parallel(*space, std::span(x).subspan(shift, n),
                            std::span(out).subspan(shift, n));
            const std::span<const Metric> all(expected);
            CHECK(checksum(std::span<const Metric>(out).subspan(shift, n)) ==
                  checksum(all.subspan(shift, n)));
            if (shift > 0) CHECK(out[shift - 1] == untouched);
            CHECK((n + shift >= out.size() || out[n + shift] == untouched));
        }
    }
}

}  // namespace controlspace::sample_parallel_test
