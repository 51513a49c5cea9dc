// SPDX-License-Identifier: Apache-2.0
#include "controlspace/space/control_space_file.h"

#include "case_of_each.h"

#define XXH_INLINE_ALL
#include <tbb/global_control.h>
#include <xxhash.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstring>
#include <fstream>
#include <limits>

#include "controlspace/baselines/catalogue.h"
#include "controlspace/fields/formula_field.h"
#include "controlspace/measure/access_time.h"
#include "controlspace/sources/sampled_surfaces.h"
#include "damaged_files.h"
#include "editable_space.h"
#include "sources/files.h"
#include "space/state.h"

namespace controlspace::control_space_file_test {

using Catch::Matchers::Contains;

namespace {

const Box domain{Point(-1, -1, -1), Point(1, 1, 1)};

std::unique_ptr<EditableSpace> small_tree(std::string_view id, bool isotropic = false) {
    for (const CatalogueEntry& entry : structures()) {
        if (entry.id != id) continue;
        auto space = editable(entry.make({.domain = domain, .finest_length = 0.1}));
        space->insert({Point(0.3, 0.2, 0.1), Metric::isotropic(0.1)});
        if (!isotropic) space->insert({Point(-0.3, 0.2, 0.1), {0.1, 0.2, 0.3, 0.01, 0.02, 0.03}});
        space->grade({});
        return space;
    }
    throw std::logic_error("no such structure");
}

std::string saved(const ScratchDirectory& scratch, std::string_view id) {
    save_control_space(scratch / "field.ctrl", *small_tree(id));
    return file_text(scratch / "field.ctrl");
}

std::string loading_error(const ScratchDirectory& scratch, const std::string& bytes) {
    const auto file = scratch.file("changed.ctrl", bytes);
    return error_of([&] { load_control_space(file, structures()); });
}

template <class T>
void put(std::string& bytes, std::size_t at, T value) {
    std::memcpy(bytes.data() + at, &value, sizeof value);
}

// What makes a forged file pass for an intact one.
void sign(std::string& bytes) {
    put(bytes, 16, static_cast<std::uint64_t>(bytes.size()));
    put(bytes, bytes.size() - 8, XXH3_64bits(bytes.data(), bytes.size() - 8));
}

}  // namespace

TEST_CASE("files of control spaces: what they begin with") {
    const ScratchDirectory scratch("ctrl");
    const std::string bytes = saved(scratch, "K_oL");
    // Signature, version 6, order of bytes, size: little-endian.
    CHECK(bytes.substr(0, 16) == std::string("\x89"
                                             "CTRL\r\n\x1a\6\0\0\0\4\3\2\1",
                                             16));
    std::string signed_again = bytes;
    sign(signed_again);
    CHECK(signed_again == bytes);
    CHECK(names_in(scratch.path()) == std::vector<std::string>{"field.ctrl"});
}

TEST_CASE("files of control spaces: what is refused, and why") {
    const ScratchDirectory scratch("ctrl");
    const std::string bytes = saved(scratch, "K_V");
    CHECK_THAT(loading_error(scratch, ""), Contains("is empty"));
    CHECK_THAT(loading_error(scratch, "x,y,z,h\n0,0,0,1\n"), Contains("is no control space"));
    CHECK_THAT(error_of([&] { load_control_space(scratch / "none.ctrl", structures()); }),
               Contains("cannot read"));
    CHECK_THAT(error_of([&] { load_control_space(scratch.path(), structures()); }),
               Contains("is a directory"));

    std::string newer = bytes;
    put(newer, 8, control_space_file_version + 1);
    CHECK_THAT(loading_error(scratch, newer), Contains("format version 7, this program reads up"));
    for (const std::uint32_t version : {1, 2, 3, 4}) {
        std::string older = bytes;
        put(older, 8, version);
        CHECK_THAT(loading_error(scratch, older), Contains("read no longer: build it again"));
    }
    std::string turned = bytes;
    std::reverse(turned.begin() + 12, turned.begin() + 16);
    CHECK_THAT(loading_error(scratch, turned), Contains("order of bytes"));

    for (const std::size_t size : {std::size_t{1}, std::size_t{7}, std::size_t{23},
                                   std::size_t{100}, bytes.size() / 2, bytes.size() - 1}) {
        CHECK_THAT(loading_error(scratch, bytes.substr(0, size)), Contains("is truncated"));
    }
    CHECK_THAT(loading_error(scratch, bytes + "x"), Contains("is altered"));
    for (std::size_t i = 24; i < bytes.size(); i += 61) {
        std::string altered = bytes;
        altered[i] = static_cast<char>(altered[i] ^ 4);
        CHECK_THAT(loading_error(scratch, altered), Contains("checksum differs"));
    }

    std::vector<CatalogueEntry> octrees(structures().begin() + 3, structures().begin() + 6);
    CHECK_THAT(error_of([&] { load_control_space(scratch / "field.ctrl", octrees); }),
               Contains("'K_V', which this program does not have"));
    const auto bare = editable(tree_named("K_L").construct({.domain = domain}));
    CHECK_THAT(error_of([&] { save_control_space(scratch / "bare.ctrl", *bare); }),
               Contains("an entry of the catalogue"));
}

CASE_OF_EACH(entry, structures(),
             "forged files end in an error or in metrics, never in a crash or in much memory") {
    const ScratchDirectory scratch("ctrl");
    const auto read = [](const std::filesystem::path& file) {
        std::string bytes = file_text(file);
        if (bytes.size() > 32) sign(bytes);
        std::ofstream(file, std::ios::binary) << bytes;
        sample_at(*load_control_space(file, structures()), Point(0.1, 0.2, 0.3));
    };
    const auto check = [&](const auto& space) {
        save_control_space(scratch / "field.ctrl", space);
        // LZ4 takes 256 equal bytes for one.
        check_damaged_files(scratch.path(), "forged.ctrl", file_text(scratch / "field.ctrl"), 2000,
                            read);
    };
    const auto space = small_tree(entry.id);
    check(*space);
    if (!entry.has<CompactForm>()) return;
    check(*space->compact(Precision::floats));
    check(*small_tree(entry.id, true)->compact(Precision::log16));
    check(*small_tree(entry.id, true)->compact(Precision::log8));
}

TEST_CASE("files are the same to the bit however many threads there are, and read by any number",
          "[threads]") {
    const ScratchDirectory scratch("ctrl");
    const auto space = editable(tree_named("K_oL").make({.domain = domain, .l_min = 1}));
    space->insert(sample_sphere({.rho = 0.5}));
    REQUIRE(space->control_nodes(Neighbourhood::faces).metrics.size() > 50'000);  // some ten chunks
    const auto all_threads = [](std::size_t threads) {
        return tbb::global_control(tbb::global_control::max_allowed_parallelism, threads);
    };
    const auto saved_by = [&](const auto& saved, const char* name) {
        save_control_space(scratch / name, saved);
        return file_text(scratch / name);
    };
    std::string by_many;
    {
        const auto four = all_threads(4);
        by_many = saved_by(space->built(), "many.ctrl");
        const auto loaded = load_control_space(scratch / "many.ctrl", structures());
        CHECK(saved_by(*loaded, "again.ctrl") == by_many);
    }
    const auto one = all_threads(1);
    CHECK(saved_by(space->built(), "one.ctrl") == by_many);
    const auto loaded = load_control_space(scratch / "many.ctrl", structures());
    CHECK(saved_by(*loaded, "again.ctrl") == by_many);
}

TEST_CASE("an array that is said to be huge is refused before memory is requested") {
    const ScratchDirectory scratch("ctrl");
    const std::string bytes = saved(scratch, "K_oL");
    const std::size_t name = bytes.find("nodes.field");
    std::string forged = bytes;
    const std::size_t count = name + 11 + 8;
    put(forged, count, std::uint64_t{1} << 40);
    sign(forged);
    CHECK_THAT(loading_error(scratch, forged), Contains("nodes.field has a chunk"));
}

TEST_CASE("numbers of a forged file from which no metrics could follow are refused") {
    const ScratchDirectory scratch("ctrl");
    std::string bytes = saved(scratch, "K_LA");
    const auto refuse = [&](const std::string& array, auto before, auto forged_number) {
        // Kind and sizes of the array, size of the chunk, and the head of Blosc's buffer.
        const std::size_t at = bytes.find(array) + array.size() + 4 + 4 + 8 + 4 + 16;
        auto number = before;
        std::memcpy(&number, bytes.data() + at, sizeof number);
        REQUIRE(number == before);
        std::string forged = bytes;
        put(forged, at, forged_number);
        sign(forged);
        CAPTURE(array, forged_number);
        CHECK_THAT(loading_error(scratch, forged), Contains("changed.ctrl: its " + array));
    };
    const double nan = std::numeric_limits<double>::quiet_NaN();
    for (const double ratio : {-3.0, 0.5, 1e51, nan, HUGE_VAL})
        refuse("anchors.ratio", 1.25, ratio);
    for (const double x : {nan, -HUGE_VAL, 1e300}) refuse("sources.positions", 0.3, x);
    for (const double h : {nan, -1.0, 0.0, 1e300}) refuse("anchors.largest", std::sqrt(3), h);
    save_control_space(scratch / "leaf.ctrl", *tree_named("K_oV").make({.domain = domain}));
    bytes = file_text(scratch / "leaf.ctrl");  // one leaf: so few bytes are not compressed
    for (const std::uint32_t vertex : {1u, ~0u}) refuse("vertices.of_leaves", 0u, vertex);
    const auto h_max = [](double h) { return SpaceOptions{.domain = domain, .h_max = h}; };
    for (const double h : {nan, 0.0, 5e-324, HUGE_VAL}) {
        CHECK_THAT(error_of([&] { require_valid(h_max(h)); }), Contains("h_max is "));
    }
}

TEST_CASE("forged buffers of Blosc's with elements or blocks of another size are refused") {
    const ScratchDirectory scratch("ctrl");
    const std::string bytes = saved(scratch, "K_oL");
    const std::size_t head = bytes.find("nodes.field") + 11 + 4 + 4 + 8 + 4;
    const auto refuse = [&](std::size_t at, auto value) {
        std::string forged = bytes;
        put(forged, head + at, value);
        sign(forged);
        CHECK_THAT(loading_error(scratch, forged), Contains("nodes.field has a chunk"));
    };
    for (const char size : {'\0', '\1', '\xff'}) refuse(3, size);
    for (const std::uint32_t size : {0u, ~0u, 0x7ffffff0u}) refuse(8, size);
}

TEST_CASE("intersections without an order are answered by a loaded tree as by the saved one") {
    const ScratchDirectory scratch("ctrl");
    const std::vector<PointSource> sources = sample_sphere({.h = 0.3, .s_a = 4, .s_n = 0.25});
    const auto space = small_tree("K_oLA");
    space->adapt({sources, nullptr, 1.25, 1.0, IntersectionRule::order_free});
    save_control_space(scratch / "field.ctrl", *space);
    const auto loaded = load_control_space(scratch / "field.ctrl", structures());
    for (const Point& x : random_points(domain, 100, 5)) {
        REQUIRE(sample_at(*loaded, x) == sample_at(*space, x));
    }
}

TEST_CASE("a program's own continuous field cannot be saved") {
    const ScratchDirectory scratch("ctrl");
    const auto field = std::make_shared<FormulaField<Metric (*)(const Point&)>>(
        [](const Point&) { return Metric::isotropic(0.5); });
    for (const char* id : {"K_oLA", "direct"}) {
        const auto space = small_tree(id);
        space->adapt({.sources = {}, .continuous = field});
        CHECK_THAT(error_of([&] { save_control_space(scratch / "no.ctrl", *space); }),
                   Contains("continuous field"));
    }
}

TEST_CASE("an array that comes twice in a file is refused") {
    StateWriter state;
    state("a", 1.0);
    state("b", 2.0);
    CHECK_NOTHROW(StateReader(state.bytes(), "f.ctrl"));
    state("a", 1.0);
    CHECK_THROWS_WITH(StateReader(state.bytes(), "f.ctrl"), Contains("is there twice"));
}

}  // namespace controlspace::control_space_file_test
