// SPDX-License-Identifier: Apache-2.0
// On a GPU, where there is one.
#include "controlspace/cuda/gpu_field.h"

#include <catch2/catch.hpp>
#include <string>
#include <vector>

#include "controlspace/error.h"
#include "controlspace/sources/sampled_surfaces.h"
#include "controlspace/space/catalogue.h"
#include "controlspace/space/make_control_space.h"
#include "geometry/random_fractions.h"

namespace controlspace::gpu_field_test {

using Catch::Matchers::Contains;

TEST_CASE("a GPU answers as octrees do, to the bit, and says where there is none") {
    const std::string id = GENERATE("K_oL", "K_oLB", "K_oV");
    const bool tensors = GENERATE(false, true);
    const Precision precision = GENERATE(Precision::doubles, Precision::floats);
    CAPTURE(id, tensors, precision);
    const Box domain{Point(0, 0, 0), Point(1, 2, 1)};
    const double h = 0.05;
    const Metric m = tensors ? Metric{h, 2 * h, h, 0.2 * h, 0, 0} : Metric::isotropic(h);
    const std::vector<PointSource> sources{{Point(0.4, 1.1, 0.3), m}, {Point(0.1, 0.3, 0.9), m}};
    const auto field =
        make_filled_builder(entry_named(tree_catalogue(), id), sources, {.domain = domain})
            ->build({.precision = precision});
    std::unique_ptr<GpuField> gpu;
    try {
        gpu = std::make_unique<GpuField>(*field, precision);
    } catch (const InputError& error) {
        REQUIRE_THAT(error.what(), Contains("GPU"));
        WARN("skipped: " << error.what());
        return;
    }
    CHECK(gpu->answers_lengths() == !tensors);
    RandomFractions random(1);
    for (const std::size_t count : {0u, 1u, 256u, 257u, 100000u}) {
        CAPTURE(count);
        std::vector<Point> x(count);
        for (Point& p : x) p = Point(1.2 * random() - 0.1, 2 * random(), random());
        std::vector<Metric> expected(count), found(count);
        field->sample(x, expected);
        gpu->sample(x, found);
        CHECK((found == expected));
        if (tensors) continue;
        std::vector<double> expected_lengths(count), lengths(count);
        field->sample_lengths(x, expected_lengths);
        gpu->sample_lengths(x, lengths);
        CHECK((lengths == expected_lengths));
    }
}

}  // namespace controlspace::gpu_field_test
