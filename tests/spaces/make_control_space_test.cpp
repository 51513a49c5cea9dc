// SPDX-License-Identifier: Apache-2.0
// A control space in one call, and the errors that a program can act on.
#include "controlspace/space/make_control_space.h"

#include <catch2/catch.hpp>
#include <vector>

#include "controlspace/baselines/catalogue.h"
#include "controlspace/input_errors.h"
#include "controlspace/measure/access_time.h"
#include "editable_space.h"

namespace controlspace::make_control_space_test {

using Catch::Matchers::Contains;

namespace {

const SpaceOptions options{.domain = {Point(-1, -1, -1), Point(1, 1, 1)}, .ratio = 1.5};
const std::vector<PointSource> sources{{Point(0.3, 0.2, 0.1), Metric::isotropic(0.05)},
                                       {Point(-0.5, 0, 0.4), {0.1, 0.2, 0.3, 0.01, 0.02, 0.03}}};

/// The error of type E that `action` throws.
template <class E, class Action>
E thrown_by(Action&& action) {
    try {
        action();
    } catch (const E& error) {
        return error;
    }
    FAIL("nothing was thrown");
    throw;
}

}  // namespace

TEST_CASE("a control space is made in one call as by its builder, with one gradation ratio") {
    const std::vector<Point> x = random_points(options.domain, 200, 1);
    for (const CatalogueEntry& entry : structures()) {
        CAPTURE(entry.id);
        const auto made = make_control_space(structures(), entry.id, sources, options);
        SpaceOptions sized = options;
        sized.finest_length = finest_length(sources);
        const auto builder = entry.make(sized);
        builder->insert(sources);
        builder->grade({.ratio = options.ratio});
        const auto built = builder->build();
        CHECK(answers(*made, x) == answers(*built, x));
    }
    // A structure that follows the sources closely shows the ratio: the length along x grows from
    // the first source at half a length per length.
    const std::vector<PointSource> one{{Point::Zero(), Metric::isotropic(0.05)}};
    AdaptationReport report;
    const auto field = make_control_space("K_oV", one, options, 0.01, &report);
    CHECK(report.met);
    CHECK(sample_at(*field, {0.4, 0, 0}).xx == Approx(0.05 + 0.5 * 0.4).epsilon(0.08));
}

TEST_CASE("what is made in one call is compact, unless it takes later sources") {
    const std::vector<PointSource> lengths{{Point(0.3, 0.2, 0.1), Metric::isotropic(0.02)},
                                           {Point(-0.5, 0, 0.4), Metric::isotropic(0.05)}};
    SpaceOptions later = options;
    later.takes_later_sources = true;
    for (const CatalogueEntry& entry : structures()) {
        CAPTURE(entry.id);
        CHECK(to_be_read(entry, options).precision.has_value() == entry.has<CompactForm>());
        CHECK_FALSE(to_be_read(entry, later).precision);
        if (!entry.has<CompactForm>()) continue;
        const auto made = make_control_space(structures(), entry.id, lengths, options);
        const auto built = make_filled_builder(entry, lengths, options)->build();
        CHECK(5 * made->footprint().bytes_total() < 4 * built->footprint().bytes_total());
    }
}

TEST_CASE("names that no structure has are refused with those there are") {
    for (const char* id : {"K_o", "", "k_ol"}) {
        const auto error =
            thrown_by<UnknownStructure>([&] { make_control_space(id, {}, options); });
        CHECK_THAT(error.what(), Contains("K_L, ") && Contains("K_oV") && Contains("K_oLA"));
    }
    const auto error = thrown_by<UnknownStructure>(
        [&] { make_control_space(structures(), "none", sources, options); });
    for (const CatalogueEntry& entry : structures()) CHECK_THAT(error.what(), Contains(entry.id));
}

TEST_CASE("an error has the index of the source, or the bytes that are wanted") {
    auto wrong = sources;
    wrong.insert(wrong.begin() + 1, {Point(0, 2, 0), Metric::isotropic(0.1)});
    for (const CatalogueEntry& entry : structures()) {
        CAPTURE(entry.id);
        const auto make = [&](std::optional<double> target) {
            return thrown_by<IndexedError>(
                       [&] { make_control_space(structures(), entry.id, wrong, options, target); })
                .index();
        };
        CHECK(make({}) == 1);
        CHECK(make(0.5) == 1);
        const auto builder = entry.make({.domain = options.domain, .finest_length = 0.05});
        CHECK(thrown_by<IndexedError>([&] { builder->insert(wrong); }).index() == 1);
    }
    SpaceOptions small = options;
    small.max_bytes = 100000;
    const std::vector<PointSource> tiny{{Point::Zero(), Metric::isotropic(1e-4)}};
    const auto error =
        thrown_by<MemoryLimitError>([&] { make_control_space("K_oV", tiny, small, 0.01); });
    CHECK(error.bytes() > small.max_bytes);
    CHECK(error.bytes() < 100 * small.max_bytes);
}

}  // namespace controlspace::make_control_space_test
