// SPDX-License-Identifier: Apache-2.0
// The C library answers as the C++ library does, and turns every failure into a status.
#include <controlspace/controlspace.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <catch2/catch.hpp>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "controlspace/baselines/catalogue.h"
#include "controlspace/measure/access_time.h"
#include "controlspace/trees/octree_pieces.h"
#include "editable_space.h"
#include "scratch_directory.h"

namespace controlspace::controlspace_test {

using Catch::Matchers::Contains;

namespace {

const Box domain{Point(-1, -1, -1), Point(1, 1, 1)};
constexpr std::array<double, 6> corners{-1, -1, -1, 1, 1, 1};
constexpr std::array<double, 3> place{0.3, 0.2, 0.1};
constexpr std::array<double, 6> tensor{0.1, 0.2, 0.3, 0.01, 0.02, 0.03};
constexpr const char* options = "split=s_G, tau=0.5 finest_length=0.1";

cspace* made(const char* structure) {
    cspace* space = nullptr;
    REQUIRE(cspace_create(structure, corners.data(), options, &space) == CSPACE_OK);
    return space;
}

std::vector<double> sampled(const cspace* space) {
    const std::vector<Point> x = random_points(domain, 200, 1);
    std::vector<double> metrics(6 * x.size());
    REQUIRE(cspace_sample(space, x.size(), x.front().data(), metrics.data()) == CSPACE_OK);
    return metrics;
}

}  // namespace

TEST_CASE("C: a domain may be a plane, and not a line") {
    const double plane[6] = {0, 0, 1, 2, 3, 1};
    cspace* space = nullptr;
    REQUIRE(cspace_create("K_oV", plane, "finest_length=0.1", &space) == CSPACE_OK);
    const double places[6] = {1, 1, 1, 0.5, 2, 1.001};
    const double lengths[2] = {0.1, 0.1};
    CHECK(cspace_insert_lengths(space, 2, places, lengths) != CSPACE_OK);  // the second is off it
    CHECK_THAT(cspace_last_error(), Contains("source 1") && Contains("outside"));
    CHECK(cspace_grade(space, 1.25) == CSPACE_OK);
    double size = 0;
    CHECK(cspace_sample_lengths(space, 1, places, &size) == CSPACE_OK);
    // A leaf of a source has edges of at most its length: no corner is more than a diagonal away.
    CHECK(size <= 0.1 + 0.25 * std::sqrt(2) * 0.1);
    cspace_free(space);
    const double line[6] = {0, 0, 1, 2, 0, 1};
    CHECK(cspace_create("K_oV", line, "", &space) != CSPACE_OK);
    CHECK_THAT(cspace_last_error(), Contains("no extent along two axes"));
}

TEST_CASE("C: every structure answers as from C++, also after saving and loading") {
    const ScratchDirectory scratch("c");
    const std::string file = (scratch / "field.ctrl").string();
    std::size_t i = 0;
    for (const CatalogueEntry& entry : structures()) {
        CAPTURE(entry.id);
        CHECK(cspace_structure(i++) == entry.id);
        cspace* space = made(entry.id.c_str());
        CHECK(cspace_insert(space, 1, place.data(), tensor.data()) == CSPACE_OK);
        const double length = 0.2;
        const double centre[3] = {0, 0, 0};
        CHECK(cspace_insert_lengths(space, 1, centre, &length) == CSPACE_OK);
        CHECK(cspace_grade(space, 1.5) == CSPACE_OK);

        const auto own = editable(entry.make(
            {.domain = domain, .split = SplitRule::golden, .l_min = 0.5, .finest_length = 0.1}));
        own->insert({Point(0.3, 0.2, 0.1), {0.1, 0.2, 0.3, 0.01, 0.02, 0.03}});
        own->insert({Point::Zero(), Metric::isotropic(0.2)});
        own->grade({.ratio = 1.5});
        const std::vector<Point> x = random_points(domain, 200, 1);
        std::vector<Metric> expected(x.size());
        own->sample(x, expected);
        const std::vector<double> metrics = sampled(space);
        for (std::size_t k = 0; k < x.size(); ++k) {
            const double* m = metrics.data() + 6 * k;
            CHECK(Metric{m[0], m[1], m[2], m[3], m[4], m[5]} == expected[k]);
        }

        std::array<double, 6> box{};
        CHECK(cspace_domain(space, box.data()) == CSPACE_OK);
        CHECK(box == corners);
        REQUIRE(cspace_save(space, file.c_str()) == CSPACE_OK);
        cspace* loaded = nullptr;
        REQUIRE(cspace_load(file.c_str(), &loaded) == CSPACE_OK);
        CHECK(sampled(loaded) == metrics);
        cspace_free(loaded);
        cspace_free(space);
    }
    CHECK(cspace_structure(i) == nullptr);
    cspace_free(nullptr);
}

TEST_CASE("C: an octree in pieces, whole and of a region") {
    const ScratchDirectory folder;
    cspace* space = made("K_oL");
    REQUIRE(cspace_insert(space, 1, place.data(), tensor.data()) == CSPACE_OK);
    REQUIRE(cspace_save(space, (folder / "field_0.ctrl").c_str()) == CSPACE_OK);
    const std::string index = folder / "field.pctrl";
    write_octree_pieces(index, domain,
                        std::vector<OctreePiece>{{folder / "field_0.ctrl", {domain}}});
    cspace* loaded = nullptr;
    REQUIRE(cspace_load_pieces(index.c_str(), nullptr, &loaded) == CSPACE_OK);
    CHECK(sampled(loaded) == sampled(space));
    CHECK(cspace_insert(loaded, 1, place.data(), tensor.data()) == CSPACE_BAD_INPUT);
    cspace_free(loaded);
    const std::array<double, 6> region{-1, -1, -1, 0, 0, 5};
    REQUIRE(cspace_load_pieces(index.c_str(), region.data(), &loaded) == CSPACE_OK);
    std::array<double, 6> box{};
    CHECK(cspace_domain(loaded, box.data()) == CSPACE_OK);
    CHECK(box == std::array<double, 6>{-1, -1, -1, 0, 0, 1});
    cspace_free(loaded);
    const std::array<double, 6> outside{2, 2, 2, 3, 3, 3};
    CHECK(cspace_load_pieces(index.c_str(), outside.data(), &loaded) == CSPACE_BAD_INPUT);
    CHECK(loaded == nullptr);
    cspace_free(space);
}

TEST_CASE("C: what cannot be used is refused with a reason") {
    cspace* none = nullptr;
    const auto refused = [&](const char* structure, const char* given) {
        CHECK(cspace_create(structure, corners.data(), given, &none) == CSPACE_BAD_INPUT);
        CHECK(none == nullptr);
        return std::string(cspace_last_error());
    };
    CHECK_THAT(refused("K_x", ""), Contains("no structure 'K_x'") && Contains("K_oLA"));
    CHECK_THAT(refused("K_L", "tau=much"), Contains("option tau is 'much'"));
    CHECK_THAT(refused("K_L", "tau=-1"), Contains("tau"));
    CHECK_THAT(refused("K_L", "colour=1"), Contains("no option 'colour'"));
    CHECK_THAT(refused("K_L", "tau=1 g_r=2 tau=1"), Contains("'tau' is given twice"));
    CHECK_THAT(refused("K_L", "tau"), Contains("name=value"));
    CHECK_THAT(refused("K_L", "split=s_X"), Contains("no split 's_X'"));
    CHECK_THAT(refused("K_L", "max_memory=nan"), Contains("max_memory"));
    CHECK_THAT(refused("uniform-nearest", nullptr), Contains("finest_length"));
    CHECK_THAT(refused(nullptr, nullptr), Contains("structure is NULL"));
    CHECK(cspace_create("K_L", nullptr, nullptr, &none) == CSPACE_BAD_INPUT);
    CHECK(cspace_create("K_L", corners.data(), nullptr, nullptr) == CSPACE_BAD_INPUT);
    CHECK(cspace_load("no/such/file.ctrl", &none) == CSPACE_BAD_INPUT);
    CHECK(cspace_grade(nullptr, 1.25) == CSPACE_BAD_INPUT);

    cspace* space = made("K_L");
    const std::vector<double> before = sampled(space);
    const double outside[3] = {3, 0, 0};
    CHECK(cspace_insert(space, 1, outside, tensor.data()) == CSPACE_BAD_INPUT);
    CHECK_THAT(cspace_last_error(), Contains("outside the domain"));
    const double negative = -1;
    CHECK(cspace_insert_lengths(space, 1, place.data(), &negative) == CSPACE_BAD_INPUT);
    CHECK(cspace_insert(space, 1, place.data(), nullptr) == CSPACE_BAD_INPUT);
    CHECK(cspace_grade(space, 0.5) == CSPACE_BAD_INPUT);
    CHECK(cspace_sample(space, 0, nullptr, nullptr) == CSPACE_OK);
    const double nan = std::nan("");
    const double places[6] = {0.3, 0.2, 0.1, 0.3, nan, 0.1};
    std::array<double, 12> metrics{};
    CHECK(cspace_sample(space, 2, places, metrics.data()) == CSPACE_BAD_INPUT);
    CHECK_THAT(cspace_last_error(), Contains("position 1 is NaN"));
    CHECK(sampled(space) == before);
    cspace_free(space);
}

TEST_CASE("C: sources with gradation ratios of their own, in a struct that may grow") {
    const double positions[6] = {0.3, 0.2, 0.1, -0.4, 0.5, 0.2}, lengths[2] = {0.1, 0.2},
                 growths[2] = {1.1, 2};
    cspace_sources sources{sizeof sources, 2, positions, nullptr, lengths, growths};
    for (const bool adapted : {false, true}) {
        cspace* space = made("K_oLA");
        if (adapted) {
            CHECK(cspace_adapt_sources(space, &sources, 1.5, 0.01, nullptr) == CSPACE_OK);
        } else {
            CHECK(cspace_insert_sources(space, &sources) == CSPACE_OK);
            CHECK(cspace_grade(space, 1.5) == CSPACE_OK);
        }
        const double near = cspace_size(space, 0.3, 0.2, 0.3);
        CHECK(near == Approx(0.1 + 0.1 * 0.2).epsilon(0.02));
        cspace_free(space);
    }
    cspace* space = made("K_oLA");
    const auto refused = [&](const cspace_sources* some) {
        CHECK(cspace_insert_sources(space, some) == CSPACE_BAD_INPUT);
        return std::string(cspace_last_error());
    };
    CHECK_THAT(refused(nullptr), Contains("sources is NULL"));
    sources.metrics = tensor.data();
    CHECK_THAT(refused(&sources), Contains("give one of them"));
    sources.metrics = sources.lengths = nullptr;
    CHECK_THAT(refused(&sources), Contains("metrics is NULL"));
    sources.struct_size = 0;
    CHECK_THAT(refused(&sources), Contains("set it to sizeof(cspace_sources)"));
    sources = {offsetof(cspace_sources, growths), 2, positions, nullptr, lengths, growths};
    CHECK(cspace_insert_sources(space, &sources) == CSPACE_OK);
    CHECK(cspace_grade(space, 1.5) == CSPACE_OK);
    CHECK(cspace_size(space, 0.3, 0.2, 0.3) == Approx(0.1 + 0.25 * 0.2).epsilon(0.02));
    cspace_free(space);
}

TEST_CASE("C: a tree that is given a target is that of C++") {
    cspace* space = made("K_oLA");
    double reached = -1;
    REQUIRE(cspace_adapt(space, 1, place.data(), tensor.data(), 1.5, 0.05, &reached) == CSPACE_OK);
    const auto own =
        editable(find_entry(structures(), "K_oLA")->make({.domain = domain, .l_min = 0.5}));
    const PointSource source{Point(0.3, 0.2, 0.1), {0.1, 0.2, 0.3, 0.01, 0.02, 0.03}};
    CHECK(reached == own->adapt({{&source, 1}, nullptr, 1.5, 0.05}).reached);
    CHECK(reached <= 0.05);
    const std::vector<double> metrics = sampled(space);
    const std::vector<Point> x = random_points(domain, 200, 1);
    for (std::size_t k = 0; k < x.size(); ++k) {
        CHECK(metrics[6 * k + 3] == sample_at(*own, x[k]).xy);
    }
    CHECK(cspace_adapt(space, 1, place.data(), tensor.data(), 1.5, 0, nullptr) == CSPACE_BAD_INPUT);
    CHECK(cspace_adapt(space, 1, nullptr, tensor.data(), 1.5, 0.1, nullptr) == CSPACE_BAD_INPUT);
    cspace_free(space);
}

TEST_CASE("C: a field is built in one step, with one gradation ratio") {
    const std::vector<double> places{0.3, 0.2, 0.1, -0.5, 0, 0.4}, lengths{0.05, 0.1};
    const auto built = [&](const cspace_options* given, double* reached = nullptr) {
        cspace* space = nullptr;
        const cspace_sources sources{sizeof sources, 2,      places.data(), nullptr,
                                     lengths.data(), nullptr};
        REQUIRE(cspace_build("K_oV", corners.data(), &sources, given, reached, &space) ==
                CSPACE_OK);
        const std::vector<double> result = sampled(space);
        cspace_free(space);
        return result;
    };
    const auto by_steps = [&](const char* text, double at_creation) {
        cspace* space = nullptr;
        REQUIRE(cspace_create("K_oV", corners.data(), text, &space) == CSPACE_OK);
        REQUIRE(cspace_insert_lengths(space, 2, places.data(), lengths.data()) == CSPACE_OK);
        REQUIRE(cspace_grade(space, at_creation) == CSPACE_OK);
        const std::vector<double> result = sampled(space);
        cspace_free(space);
        return result;
    };
    cspace_options given{};
    given.struct_size = sizeof given;
    const std::vector<double> standard = built(nullptr);
    CHECK(built(&given) == standard);
    CHECK(by_steps("", 1.25) == standard);
    CHECK(by_steps("", 0) == standard);
    given.growth = 1.5;
    CHECK(built(&given) != standard);
    CHECK(built(&given) == by_steps("g_r=1.5", 0));
    given.further = "tau=0.25";
    CHECK(built(&given) == by_steps("tau=0.25", 1.5));

    // Tensors give the same; a target is reached, or said not to be.
    double reached = 0;
    given.further = nullptr;
    built(&given, &reached);
    CHECK(std::isnan(reached));
    given.delta = 0.05;
    const std::vector<double> adapted = built(&given, &reached);
    CHECK((reached > 0 && reached <= 0.05));
    std::vector<double> tensors;
    for (const double h : lengths) tensors.insert(tensors.end(), {h, h, h, 0, 0, 0});
    cspace* space = nullptr;
    const cspace_sources sources{sizeof sources, 2,       places.data(),
                                 tensors.data(), nullptr, nullptr};
    REQUIRE(cspace_build("K_oV", corners.data(), &sources, &given, nullptr, &space) == CSPACE_OK);
    CHECK(sampled(space) == adapted);
    cspace_free(space);
}

TEST_CASE("C: a field built in one step is only read, unless it takes later sources") {
    const double length = 0.05, longer = 0.1, elsewhere[] = {-0.5, 0, 0.4};
    const cspace_sources sources{sizeof sources, 1, place.data(), nullptr, &length, nullptr};
    const cspace_sources more{sizeof more, 1, elsewhere, nullptr, &longer, nullptr};
    for (const char* structure : {"K_oV", "K_L", "K_oLA", "uniform-nearest"}) {
        CAPTURE(structure);
        cspace_options given{};
        given.struct_size = sizeof given;
        const auto built = [&] {
            cspace* space = nullptr;
            REQUIRE(cspace_build(structure, corners.data(), &sources, &given, nullptr, &space) ==
                    CSPACE_OK);
            return space;
        };
        cspace* read_only = built();
        const std::vector<double> before = sampled(read_only);
        const double size = cspace_size(read_only, elsewhere[0], elsewhere[1], elsewhere[2]);
        CHECK(cspace_insert_sources(read_only, &more) == CSPACE_BAD_INPUT);
        CHECK_THAT(cspace_last_error(), Contains("takes_later_sources=1"));
        CHECK(cspace_grade(read_only, 0) == CSPACE_BAD_INPUT);
        CHECK(sampled(read_only) == before);
        cspace_free(read_only);

        given.further = "takes_later_sources=1";
        cspace* growing = built();
        CHECK(sampled(growing) == before);
        CHECK(cspace_insert_sources(growing, &more) == CSPACE_OK);
        CHECK(cspace_grade(growing, 0) == CSPACE_OK);
        CHECK(cspace_size(growing, elsewhere[0], elsewhere[1], elsewhere[2]) < 0.75 * size);
        cspace_free(growing);
    }
}

TEST_CASE("C: the caller can stop a field that is being built", "[threads]") {
    const std::vector<Point> x = random_points(domain, 200'000, 5);
    const std::vector<double> lengths(x.size(), 1e-4);
    const cspace_sources sources{sizeof sources, x.size(),       x.front().data(),
                                 nullptr,        lengths.data(), nullptr};
    for (const char* structure : {"K_oV", "K_L", "uniform-nearest"}) {
        for (const double delta : {0.0, 1e-6}) {
            if (delta == 0 && structure[0] == 'u') continue;  // takes no time
            for (const bool at_once : {true, false}) {
                CAPTURE(structure, delta, at_once);
                int stop = at_once ? 1 : 0;
                cspace_options given{};
                given.struct_size = sizeof given;
                given.delta = delta;
                given.further = "tau=0.01";
                given.stop = &stop;
                std::thread other([&] {
                    std::this_thread::sleep_for(std::chrono::milliseconds(100));
                    std::atomic_ref(stop).store(1);
                });
                cspace* space = nullptr;
                CHECK(cspace_build(structure, corners.data(), &sources, &given, nullptr, &space) ==
                      CSPACE_FAILURE);
                CHECK_THAT(cspace_last_error(), Contains("stopped by the caller"));
                CHECK(space == nullptr);
                other.join();
            }
        }
    }
}

TEST_CASE("C: options of other versions are understood, or refused") {
    // The caller's, with a member that is not known yet.
    struct Newer {
        cspace_options known;
        double later;
    } newer{};
    newer.known.struct_size = sizeof newer;
    newer.known.growth = 1.5;
    const double length = 0.1;
    const auto build = [&](const cspace_options& given) {
        cspace* space = nullptr;
        const cspace_sources sources{sizeof sources, 1, place.data(), nullptr, &length, nullptr};
        const cspace_status status =
            cspace_build("K_oL", corners.data(), &sources, &given, nullptr, &space);
        CHECK((space == nullptr) == (status != CSPACE_OK));
        const std::vector<double> metrics = space ? sampled(space) : std::vector<double>();
        cspace_free(space);
        return std::pair(status, metrics);
    };
    const auto [status, whole] = build(newer.known);
    CHECK(status == CSPACE_OK);
    newer.later = 1;
    CHECK(build(newer.known).first == CSPACE_BAD_INPUT);
    CHECK_THAT(cspace_last_error(), Contains("does not know"));

    // One from before `delta`: what lies there is no member.
    cspace_options older{};
    older.struct_size = offsetof(cspace_options, delta);
    older.growth = 1.5;
    older.delta = -1;
    CHECK(build(older).second == whole);
    older.struct_size = 0;
    CHECK(build(older).first == CSPACE_BAD_INPUT);
    CHECK_THAT(cspace_last_error(), Contains("set it to sizeof(cspace_options)"));

    cspace* space_after_failure = reinterpret_cast<cspace*>(&newer);
    CHECK(cspace_build("K_oL", corners.data(), nullptr, nullptr, nullptr, &space_after_failure) ==
          CSPACE_BAD_INPUT);
    CHECK(space_after_failure == nullptr);

    cspace_options twice{};
    twice.struct_size = sizeof twice;
    twice.growth = 1.5;
    twice.further = "g_r=1.5";
    CHECK(build(twice).first == CSPACE_BAD_INPUT);
    CHECK_THAT(cspace_last_error(), Contains("given twice"));
}

TEST_CASE("C: errors say which item is wrong, and how much memory is wanted") {
    const double places[] = {0, 0, 0, 0.5, 0, 0, 7, 0, 0};
    const double lengths[] = {0.1, 0.1, 0.1}, not_a_length[] = {0.1, -1, 0.1};
    cspace* space = made("K_oL");
    CHECK(cspace_insert_lengths(space, 3, places, lengths) == CSPACE_BAD_INPUT);
    CHECK(cspace_last_error_index() == 2);
    CHECK(cspace_last_error_bytes() == 0);
    CHECK(cspace_insert_lengths(space, 2, places, not_a_length) == CSPACE_BAD_INPUT);
    CHECK(cspace_last_error_index() == 1);
    CHECK(cspace_grade(space, 0.5) == CSPACE_BAD_INPUT);
    CHECK(cspace_last_error_index() == CSPACE_NO_INDEX);
    const double with_nan[] = {0, 0, 0, 0, std::nan(""), 0};
    double metrics[12];
    CHECK(cspace_sample(space, 2, with_nan, metrics) == CSPACE_BAD_INPUT);
    CHECK(cspace_last_error_index() == 1);
    const double indefinite[] = {1, 1, 1, 0, 0, 0, 1, 1, -1, 0, 0, 0};
    CHECK(cspace_to_riemannian(2, indefinite, metrics) == CSPACE_BAD_INPUT);
    CHECK(cspace_last_error_index() == 1);
    cspace_free(space);

    cspace_options given{};
    given.struct_size = sizeof given;
    given.max_memory = 1e-4;
    given.delta = 0.01;
    const double tiny[] = {1e-3, 1e-3};
    for (const char* structure : {"K_oL", "K_L", "K_oV"}) {
        CAPTURE(structure);
        const cspace_sources sources{sizeof sources, 2, places, nullptr, tiny, nullptr};
        CHECK(cspace_build(structure, corners.data(), &sources, &given, nullptr, &space) ==
              CSPACE_BAD_INPUT);
        CHECK_THAT(cspace_last_error(), Contains("max_memory"));
        // More than the cap.
        CHECK(static_cast<double>(cspace_last_error_bytes()) > 1e-4 * (1 << 30));
        CHECK(cspace_last_error_index() == CSPACE_NO_INDEX);
    }
}

TEST_CASE("C: lengths, also as Gmsh asks for them, are the smallest of the metrics") {
    cspace* space = made("K_oV");
    REQUIRE(cspace_insert(space, 1, place.data(), tensor.data()) == CSPACE_OK);
    REQUIRE(cspace_grade(space, 1.5) == CSPACE_OK);
    const std::vector<double> metrics = sampled(space);
    const std::vector<Point> x = random_points(domain, 200, 1);
    std::vector<double> lengths(x.size());
    REQUIRE(cspace_sample_lengths(space, x.size(), x.front().data(), lengths.data()) == CSPACE_OK);
    for (std::size_t k = 0; k < x.size(); ++k) {
        const double* m = metrics.data() + 6 * k;
        const double length = eigen_frame({m[0], m[1], m[2], m[3], m[4], m[5]}).lengths[0];
        CHECK(lengths[k] == Approx(length));
        const auto [px, py, pz] = std::array{x[k].x(), x[k].y(), x[k].z()};
        CHECK(cspace_size(space, px, py, pz) == lengths[k]);
        CHECK(cspace_gmsh_size(3, 1, px, py, pz, 1e22, space) == lengths[k]);
        CHECK(cspace_gmsh_size(3, 1, px, py, pz, 1e-6, space) == 1e-6);
        CHECK(cspace_gmsh_size_4_8(3, 1, px, py, pz, space) == lengths[k]);
    }
    const double nan = std::nan("");
    CHECK(std::isnan(cspace_size(space, 0, nan, 0)));
    CHECK(std::isnan(cspace_size(nullptr, 0, 0, 0)));
    CHECK(cspace_gmsh_size(3, 1, 0, nan, 0, 0.5, space) == 0.5);
    CHECK(cspace_gmsh_size_4_8(3, 1, 0, nan, 0, space) > 1e100);
    cspace_free(space);
}

TEST_CASE("C: sizes place by place follow each change, in every thread", "[threads]") {
    cspace* space = made("K_oV");
    const std::vector<Point> places = random_points(domain, 4, 2);
    std::vector<Point> walk{places.front()};
    for (const Point& step : random_points(domain, 2000, 3)) {
        walk.push_back(nearest_in(domain, walk.back() + 0.05 * step));
    }
    std::vector<double> lengths(walk.size());
    const auto count_others = [&] {
        std::size_t others = 0;
        for (std::size_t k = 0; k < walk.size(); ++k) {
            const Point& x = walk[k];
            const double size = cspace_gmsh_size(3, 1, x.x(), x.y(), x.z(), 1e22, space);
            others += size == lengths[k] ? 0 : 1;
        }
        return others;
    };
    for (const Point& place_of_source : places) {
        const double length = 0.05;
        REQUIRE(cspace_insert_lengths(space, 1, place_of_source.data(), &length) == CSPACE_OK);
        REQUIRE(cspace_sample_lengths(space, walk.size(), walk.front().data(), lengths.data()) ==
                CSPACE_OK);
        std::array<std::size_t, 3> others{1, 1, 1};
        std::vector<std::thread> threads;
        for (std::size_t& o : others) threads.emplace_back([&] { o = count_others(); });
        CHECK(count_others() == 0);
        for (std::thread& thread : threads) thread.join();
        CHECK(std::ranges::count(others, 0u) == 3);
    }
    cspace_free(space);
}

TEST_CASE("C: lengths of edges") {
    cspace* space = made("K_oL");
    const double length = 0.1;
    REQUIRE(cspace_insert_lengths(space, 1, place.data(), &length) == CSPACE_OK);
    REQUIRE(cspace_grade(space, 1) == CSPACE_OK);
    const std::array<double, 6> from{0, 0, 0, 0.1, 0.2, 0.3}, to{0.5, 0, 0, 0.1, 0.2, 0.2};
    std::array<double, 2> lengths{};
    REQUIRE(cspace_edge_lengths(space, 2, from.data(), to.data(), lengths.data()) == CSPACE_OK);
    CHECK(lengths[0] == Approx(5));
    CHECK(lengths[1] == Approx(1));
    CHECK(cspace_edge_lengths(space, 2, from.data(), nullptr, lengths.data()) == CSPACE_BAD_INPUT);
    cspace_free(space);
}

TEST_CASE("C: the length of an edge weighs its ends once and its middle four times") {
    cspace* space = made("direct");
    const double length = 0.1;
    REQUIRE(cspace_insert_lengths(space, 1, place.data(), &length) == CSPACE_OK);
    REQUIRE(cspace_grade(space, 2) == CSPACE_OK);
    // Away from the source lengths are 0.1 + d; Simpson's rule of 1/h over an edge of length 0.4.
    const std::array<double, 3> to{place[0] + 0.4, place[1], place[2]};
    double found = 0;
    REQUIRE(cspace_edge_lengths(space, 1, place.data(), to.data(), &found) == CSPACE_OK);
    CHECK(found == Approx(0.4 / 6 * (1 / 0.1 + 4 / 0.3 + 1 / 0.5)));
    cspace_free(space);
}

TEST_CASE("C: the depth of kd-trees and that of octrees are limited each by its own option") {
    const auto longest_edge = [](const char* structure, const char* depth) {
        cspace* space = nullptr;
        REQUIRE(cspace_create(structure, corners.data(), depth, &space) == CSPACE_OK);
        const double length = 0.01;
        REQUIRE(cspace_insert_lengths(space, 1, place.data(), &length) == CSPACE_OK);
        std::array<double, 6> near{};
        const std::array<double, 3> beside{place[0] + 0.2, place[1], place[2]};
        REQUIRE(cspace_sample(space, 1, beside.data(), near.data()) == CSPACE_OK);
        cspace_free(space);
        return near[0];
    };
    // A tree of one leaf holds the source's length everywhere; a deep one does not.
    CHECK(longest_edge("K_oL", "octree_depth=0") == 0.01);
    CHECK(longest_edge("K_oL", "kd_depth=0") > 0.1);
    CHECK(longest_edge("K_L", "kd_depth=0") == 0.01);
    CHECK(longest_edge("K_L", "octree_depth=0") > 0.1);
}

TEST_CASE("C: a loaded space grades by the ratio that it was created with") {
    const ScratchDirectory folder;
    const std::string file = (folder / "field.ctrl").string();
    cspace *space = nullptr, *loaded = nullptr;
    REQUIRE(cspace_create("K_oV", corners.data(), "g_r=1.7 takes_later_sources=1", &space) ==
            CSPACE_OK);
    const double length = 0.1;
    REQUIRE(cspace_insert_lengths(space, 1, place.data(), &length) == CSPACE_OK);
    REQUIRE(cspace_save(space, file.c_str()) == CSPACE_OK);
    REQUIRE(cspace_load(file.c_str(), &loaded) == CSPACE_OK);
    const std::vector<double> inserted = sampled(space);
    REQUIRE(cspace_grade(space, 0) == CSPACE_OK);
    REQUIRE(cspace_grade(loaded, 0) == CSPACE_OK);
    CHECK(sampled(space) != inserted);
    CHECK(sampled(loaded) == sampled(space));
    cspace_free(loaded);
    cspace_free(space);
}

TEST_CASE("C: a .vdb holds the lengths of structures that can be saved to one, as floats") {
    const ScratchDirectory folder;
    const std::string file = (folder / "field.vdb").string();
    for (const CatalogueEntry& entry : structures()) {
        CAPTURE(entry.id);
        cspace *space = made(entry.id.c_str()), *loaded = nullptr;
        const double length = 0.1;
        REQUIRE(cspace_insert_lengths(space, 1, place.data(), &length) == CSPACE_OK);
        REQUIRE(cspace_grade(space, 1.5) == CSPACE_OK);
        if (entry.has<VdbFiles>()) {
            REQUIRE(cspace_save(space, file.c_str()) == CSPACE_OK);
            REQUIRE(cspace_load(file.c_str(), &loaded) == CSPACE_OK);
            const std::vector<double> theirs = sampled(loaded), own = sampled(space);
            for (std::size_t i = 0; i < own.size(); ++i) {
                REQUIRE(theirs[i] == Approx(own[i]).epsilon(1e-7));
            }
            cspace_free(loaded);
        } else {
            CHECK(cspace_save(space, file.c_str()) == CSPACE_BAD_INPUT);
        }
        cspace_free(space);
    }
}

TEST_CASE("C: large batches run on all cores, with the same bits", "[threads]") {
    cspace* space = made("K_oV");
    REQUIRE(cspace_insert(space, 1, place.data(), tensor.data()) == CSPACE_OK);
    REQUIRE(cspace_grade(space, 1.5) == CSPACE_OK);
    constexpr std::size_t n = 150000, few = 1000;
    std::vector<Point> x = random_points(domain, n, 1);
    std::vector<double> metrics(6 * n), lengths(n), first(6 * few);
    REQUIRE(cspace_sample(space, n, x.front().data(), metrics.data()) == CSPACE_OK);
    REQUIRE(cspace_sample_lengths(space, n, x.front().data(), lengths.data()) == CSPACE_OK);
    for (const std::size_t begin : {std::size_t{0}, n - few}) {
        REQUIRE(cspace_sample(space, few, x[begin].data(), first.data()) == CSPACE_OK);
        CHECK(std::equal(first.begin(), first.end(), metrics.begin() + 6 * begin));
        REQUIRE(cspace_sample_lengths(space, few, x[begin].data(), first.data()) == CSPACE_OK);
        CHECK(std::equal(lengths.begin() + begin, lengths.begin() + begin + few, first.begin()));
    }
    lengths.assign(n, -1);
    x[n - 2].y() = x[n / 2].x() = std::nan("");
    CHECK(cspace_sample_lengths(space, n, x.front().data(), lengths.data()) == CSPACE_BAD_INPUT);
    CHECK_THAT(cspace_last_error(), Contains("position 75000 is NaN"));
    CHECK(lengths[0] == -1);
    metrics[6 * (n / 3)] = metrics[6 * (n - 1)] = -1;
    CHECK(cspace_to_riemannian(n, metrics.data(), metrics.data()) == CSPACE_BAD_INPUT);
    CHECK_THAT(cspace_last_error(), Contains("metric 50000 is not positive definite"));
    cspace_free(space);
}

TEST_CASE("C: metrics become Riemannian ones and come back") {
    std::array<double, 12> metrics{0.5, 0.25, 0.1, 0, 0, 0};
    std::copy(tensor.begin(), tensor.end(), metrics.begin() + 6);
    std::array<double, 12> other = metrics;
    REQUIRE(cspace_to_riemannian(2, other.data(), other.data()) == CSPACE_OK);
    CHECK(other[0] == Approx(4));
    CHECK(other[1] == Approx(16));
    CHECK(other[2] == Approx(100));
    CHECK(other[3] == Approx(0).margin(1e-12));
    REQUIRE(cspace_from_riemannian(2, other.data(), other.data()) == CSPACE_OK);
    for (std::size_t i = 0; i < 12; ++i) CHECK(other[i] == Approx(metrics[i]).margin(1e-12));
    metrics[8] = -1;
    CHECK(cspace_to_riemannian(2, metrics.data(), other.data()) == CSPACE_BAD_INPUT);
    CHECK_THAT(cspace_last_error(), Contains("metric 1 is not positive definite"));
    CHECK(cspace_from_riemannian(2, metrics.data(), other.data()) == CSPACE_BAD_INPUT);
    CHECK(cspace_from_riemannian(1, nullptr, other.data()) == CSPACE_BAD_INPUT);
}

TEST_CASE("C: each thread has a last error of its own", "[threads]") {
    CHECK(cspace_grade(nullptr, 1.25) == CSPACE_BAD_INPUT);
    std::string other = "not asked";
    std::thread([&] { other = cspace_last_error(); }).join();
    CHECK(other.empty());
    CHECK_THAT(cspace_last_error(), Contains("space is NULL"));
}

}  // namespace controlspace::controlspace_test
