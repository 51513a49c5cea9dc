// On a GPU, where there is one.
#include "controlspace/cuda/gpu_field.h"

#include <catch2/catch.hpp>
#include <string>
#include <vector>

#include "controlspace/error.h"
#include "controlspace/sources/sampled_surfaces.h"
#include "controlspace/space/make_control_space.h"
#include "geometry/random_fractions.h"

using namespace controlspace;
using Catch::Matchers::Contains;

TEST_CASE("a GPU answers as octrees do, to the bit, and says where there is none") {
    const std::string id = GENERATE("K_oL", "K_oV");
    const bool tensors = GENERATE(false, true);
    const Box domain{Point(0, 0, 0), Point(1, 2, 1)};
    const double h = 0.05;
    const Metric m = tensors ? Metric{h, 2 * h, h, 0.2 * h, 0, 0} : Metric::isotropic(h);
    const std::vector<PointSource> sources{{Point(0.4, 1.1, 0.3), m}, {Point(0.1, 0.3, 0.9), m}};
    const auto field = make_control_space(id, sources, {.domain = domain});
    std::unique_ptr<GpuField> gpu;
    try {
        gpu = std::make_unique<GpuField>(*field, Precision::doubles);
    } catch (const InputError& error) {
        REQUIRE_THAT(error.what(), Contains("GPU"));
        WARN("skipped: " << error.what());
        return;
    }
    RandomFractions random(1);
    std::vector<Point> x(100000);
    for (Point& p : x) p = Point(random(), 2 * random(), random());
    std::vector<Metric> expected(x.size()), found(x.size());
    field->sample(x, expected);
    gpu->sample(x, found);
    CHECK(found == expected);
    CHECK(gpu->answers_lengths() == !tensors);
}
