// SPDX-License-Identifier: Apache-2.0
// The largest length, in all structures.
#include <catch2/catch.hpp>

#include "contract/structure_case.h"
#include "controlspace/space/control_space_file.h"
#include "fields/values.h"
#include "metric/draw.h"
#include "scratch_directory.h"

namespace controlspace::h_max_test {
namespace {

const Box domain{{-1, -1, -1}, {1, 1, 2}};
constexpr double h_max = 0.25;
const std::vector<PointSource> sources{{{0.5, 0.25, -0.5}, Metric::isotropic(0.05)},
                                       {{-0.5, 0.25, 1.5}, Metric::isotropic(0.1)}};

double exact_at(const Point& x) {
    double h = h_max;
    for (const PointSource& s : sources) {
        h = std::min(h, s.metric.xx + 0.25 * (x - s.position).norm());
    }
    return h;
}

/// Largest factor between lengths of a space and the exact ones.
double worst(const ControlSpace& space, double beyond) {
    Draw draw(1);
    double factor = 1;
    for (int i = 0; i < 2000; ++i) {
        const Point x(draw.uniform(-1, 1), draw.uniform(-1, 1), draw.uniform(-1, 2));
        const double h = value_at(space, x).xx;
        CHECK(h <= h_max * beyond);
        factor = std::max({factor, h / exact_at(x), exact_at(x) / h});
    }
    return factor;
}

}  // namespace

STRUCTURE_CASE(does_not_round, "no length is longer than h_max, new, graded, adapted and loaded") {
    const ScratchDirectory folder;
    const SpaceOptions options{.domain = domain, .finest_length = 0.05, .h_max = h_max};
    const auto make = [&] { return structure.make(options); };
    // Quadratic leaves interpolate beyond their nodes.
    const double beyond = structure.has<QuadraticLeaves>() ? 1.05 : 1 + 1e-6;
    const Point far(-0.9, -0.9, -0.9);
    CHECK(value_at(*make()->build(), far).xx == Approx(h_max).epsilon(1e-6));
    const auto graded = make();
    graded->insert(sources);
    graded->grade({.ratio = 1.25});
    CHECK(worst(*graded->build(), beyond) < 4);
    CHECK(value_at(*graded->build(), far).xx == Approx(h_max).epsilon(1e-3));
    save_control_space(folder / "f.ctrl", *graded->build());
    const auto loaded = load_control_space(folder / "f.ctrl", structures());
    CHECK(value_at(*loaded, far) == value_at(*graded->build(), far));
    CHECK(recipe_of(*loaded)->options.h_max == h_max);
    if (structure.has<VoxelSize>()) return;
    const auto adapted = make();
    const AdaptationReport report =
        adapted->adapt({.sources = sources, .continuous = nullptr, .ratio = 1.25, .target = 0.05});
    CHECK(report.met);
    CHECK(worst(*adapted->build(), beyond) < 1.19);
    // A limit of the goal alone is saved too.
    const auto limited = structure.make({.domain = domain, .finest_length = 0.05});
    limited->adapt(
        {.sources = sources, .continuous = nullptr, .ratio = 1.25, .target = 0.05, .h_max = h_max});
    CHECK(value_at(*limited->build(), far).xx <= h_max * beyond);
    save_control_space(folder / "limited.ctrl", *limited->build());
    CHECK(value_at(*load_control_space(folder / "limited.ctrl", structures()), far) ==
          value_at(*limited->build(), far));
}

}  // namespace controlspace::h_max_test
