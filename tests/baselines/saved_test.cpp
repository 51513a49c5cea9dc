// SPDX-License-Identifier: Apache-2.0
#include <catch2/catch.hpp>

#include "baselines/fixtures.h"
#include "controlspace/error.h"
#include "controlspace/space/control_space_file.h"
#include "scratch_directory.h"

// Files of all structures, over domains and sources that leave most of a structure empty.

namespace controlspace::saved_test {
namespace {

struct Workload {
    const char* name;
    SpaceOptions options;
    std::vector<PointSource> sources;
};

SpaceOptions options_over(const Vector& edges, double voxel) {
    SpaceOptions options;
    options.domain = {Point::Zero(), edges};
    options.voxel = voxel;
    options.finest_length = voxel;
    return options;
}

std::vector<Workload> workloads() {
    std::vector<Workload> all{
        {"tiny", options_over({1e-6, 2e-6, 1e-6}, 1e-7), {}},
        {"thin", options_over({100, 0.1, 0.1}, 0.1), {}},
        {"thinner", options_over({1000, 0.1, 0.1}, 0.1), {}},
        {"flat", options_over({10, 10, 0.1}, 0.1), {}},
        {"flat, with later sources", options_over({10, 10, 0.1}, 0.1), {}},
        {"lone source", options_over({1, 1, 1}, 0.05), {}},
        {"no source", options_over({1, 1, 1}, 0.25), {}},
    };
    all[4].options.takes_later_sources = true;
    for (Workload& work : all) {
        if (&work == &all.back()) break;
        const Box& box = work.options.domain;
        const Metric requested = Metric::isotropic(2 * work.options.voxel);
        work.sources = {{box.low + 0.3 * box.edges(), requested}};
        if (&work != &all[5]) work.sources.push_back({box.low + 0.9 * box.edges(), requested});
    }
    return all;
}

}  // namespace

TEST_CASE("every structure loads again from tiny, thin, flat and nearly empty domains") {
    const auto entry = GENERATE(from_range(structures().begin(), structures().end()));
    const Workload work = GENERATE(from_range(workloads()));
    INFO(entry.id << ", " << work.name);
    if (work.options.takes_later_sources && entry.id == "openvdb-vec3s-trilinear") {
        CHECK_THROWS_AS(entry.make(work.options), InputError);
        return;
    }
    const auto builder = entry.make(work.options);
    builder->insert(work.sources);
    builder->grade({});
    const auto space = builder->build();

    const ScratchDirectory folder;
    std::mt19937_64 random(23);
    std::vector<Point> x;
    for (int i = 0; i < 500; ++i) x.push_back(random_point(random, work.options.domain));
    const std::vector<Metric> expected = sample(*space, x);
    const std::filesystem::path file = folder / "saved.ctrl";
    save_control_space(file, *space);
    CHECK(sample(*load_control_space(file, structures()), x) == expected);
    save_control_space(file, *builder);
    const SavedControlSpace saved = open_control_space(file, structures());
    CHECK(sample(*saved.space, x) == expected);
    CHECK(saved.space->footprint().bytes_total() <= space->footprint().bytes_total());
}

}  // namespace controlspace::saved_test
