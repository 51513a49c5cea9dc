// SPDX-License-Identifier: Apache-2.0
// Insertion, gradation, building and queries over and over again on one builder take no memory that
// is not given back. CONTROLSPACE_ROUNDS: how many rounds, 2000 unless given.
#include <catch2/catch.hpp>
#include <cstdlib>
#include <string>

#include "case_of_each.h"
#include "controlspace/baselines/catalogue.h"
#include "controlspace/space/control_nodes.h"
#include "counting_allocator.h"
#include "geometry/random_fractions.h"

namespace controlspace::rounds_test {
namespace {

std::vector<CatalogueEntry> of_control_nodes() {
    std::vector<CatalogueEntry> found;
    const SpaceOptions options{.domain = {Point::Zero(), Point::Ones()}, .finest_length = 0.2};
    for (const CatalogueEntry& entry : structures()) {
        if (dynamic_cast<NodeBuilder*>(entry.make(options).get()) != nullptr)
            found.push_back(entry);
    }
    return found;
}

int rounds() {
    const char* const given = std::getenv("CONTROLSPACE_ROUNDS");
    return given == nullptr ? 2000 : std::stoi(given);
}

}  // namespace

CASE_OF_EACH(entry, of_control_nodes(), "many rounds of insertion and gradation", "") {
    const Box domain{Point::Zero(), Point::Ones()};
    auto made = entry.make({.domain = domain, .finest_length = 0.2});
    auto& builder = dynamic_cast<NodeBuilder&>(*made);
    RandomFractions fraction(1);
    std::vector<PointSource> sources;
    for (int i = 0; i < 40; ++i) {
        const Point x(fraction(), fraction(), fraction());
        Metric m = Metric::isotropic(0.2 + 0.3 * fraction());
        if (i % 2 == 0) m.xx *= 0.7;
        sources.push_back({x, m});
    }
    double sum = 0;
    const auto round = [&](int i) {
        builder.insert(sources[static_cast<std::size_t>(i) % sources.size()]);
        builder.grade({.schedule = GradationSchedule::queue});
        const auto space = builder.build();
        sum += space->length_at({fraction(), fraction(), fraction()});
        // What it was given is forgotten, or it would keep the sources of all rounds.
        const std::vector<Metric> metrics =
            control_nodes(*space, Neighbourhood::faces).value().metrics;
        builder.assign(metrics);
    };
    int i = 0;
    while (i < 200) round(i++);
    const std::size_t before = live_bytes();
    for (const int end = i + rounds(); i < end; ++i) round(i);
    CHECK(live_bytes() <= before);
    CHECK(sum > 0);
}

}  // namespace controlspace::rounds_test
