// SPDX-License-Identifier: Apache-2.0
#include <catch2/catch.hpp>
#include <utility>

#include "cli/paper_reference.h"
#include "controlspace/error.h"
#include "controlspace/gradation/law.h"
#include "controlspace/study/study.h"
#include "data_folder.h"

namespace controlspace::study_file_test {

using Catch::Matchers::Contains;

namespace {

Study parse(std::string_view text) {
    return parse_study(text, "folder/my-study.toml", program_parameters());
}

/// What reading `text` complains of.
std::string complaint(std::string_view text) {
    try {
        parse(text);
    } catch (const InputError& error) {
        return error.what();
    }
    return "";
}

}  // namespace

TEST_CASE("an empty study file is one run of defaults, named as the file") {
    const Study study = parse("");
    CHECK(study.name == "my-study");
    CHECK(study.sources == SourcesChoice{});
    REQUIRE(study.runs.size() == 1);
    CHECK(study.runs[0].structures() == Values{"all"});
    CHECK(study.runs[0].find("tau") == nullptr);
}

TEST_CASE("every key of a study file is read") {
    const Study study = parse(R"(
        name = "n"
        sources = "planes"
        centre = [0.5, -1, 2]
        radius = 0.5
        slope = 2
        h = 0.25
        domain = [-1, 1, -2, 2, -3, 3.5]
        margin = 0.125
        h_min = 0.01
        h_max = 0.75
        max_memory = 0.5
        seed = 7
        threads = 3
        access_points = 1000
        access_repeats = 5
        creation_repeats = 2
        probe_grid = 12
        fine_probe_grid = 13
        reference_tolerance = 0.001
        output = "out"
        field_centre = [1, 2, 3]
        field_radius = 0.75
        field_slope = 0.5
        field_lengths = [0.01, 0.04]
        field_growth = 0.125
        field_largest = 0.5
        [[runs]]
        structures = ["K_L", "K_V"]
        rho = [1, 0.5]
        tau = 0.25
        [[runs]]
        mmg_hgrad = 1.3
        [[runs]]
        refine_beta = [1.5])");
    CHECK(study.name == "n");
    CHECK(study.sources.kind == SourcesKind::planes);
    CHECK(study.sources.centre == Point(0.5, -1, 2));
    CHECK(study.sources.radius == 0.5);
    CHECK(study.sources.slope == 2);
    CHECK(study.sources.h == 0.25);
    CHECK(study.domain == Box{{-1, -2, -3}, {1, 2, 3.5}});
    CHECK(study.margin == 0.125);
    CHECK(study.sources.h_min == 0.01);
    CHECK(study.sources.h_max == 0.75);
    CHECK(study.max_memory_gib == 0.5);
    CHECK(study.seed == 7);
    CHECK(study.threads == 3);
    CHECK(study.access_points == 1000);
    CHECK(study.access_repeats == 5);
    CHECK(study.creation_repeats == 2);
    CHECK(study.probe_grid == 12);
    CHECK(study.fine_probe_grid == 13);
    CHECK(study.reference_tolerance == 0.001);
    CHECK(study.output == "out");
    const FieldChoice& field = study.sources.field;
    CHECK(field.centre == Point(1, 2, 3));
    CHECK(field.radius == 0.75);
    CHECK(field.slope == 0.5);
    CHECK(field.lengths == SurfaceLengths{0.01, 0.04, 0.125, 0.5});
    REQUIRE(study.runs.size() == 3);
    const auto list = [&](const std::string& key) { return to_string(*study.runs[0].find(key)); };
    CHECK(list("structures") == "K_L, K_V");
    CHECK(list("rho") == "1, 0.5");
    CHECK(list("tau") == "0.25");
    CHECK(*study.runs[1].find("g_r") == Values{gradation_ratio_from_mmg(1.3)});
    CHECK(*study.runs[2].find("g_r") == Values{gradation_ratio_from_refine(1.5)});
}

TEST_CASE("keys of a run at the top are for all runs that do not set them") {
    const Study study = parse("tau = [1, 0.5]\nrho = 0.2\n[[runs]]\n[[runs]]\ntau = 0.1\n");
    REQUIRE(study.runs.size() == 2);
    CHECK(*study.runs[0].find("tau") == Values{1, 0.5});
    CHECK(*study.runs[1].find("tau") == Values{0.1});
    CHECK(*study.runs[1].find("rho") == Values{0.2});
}

TEST_CASE("a study may have no sources, or those of a file called so") {
    CHECK(parse("sources = 'none'").sources.kind == SourcesKind::none);
    CHECK(parse("sources = './none'").sources.kind == SourcesKind::file);
}

TEST_CASE("a file of sources is looked for beside the study file") {
    CHECK(parse("sources = 'a/b.csv'").sources.files.at(0) == "folder/a/b.csv");
    CHECK(parse("sources = '/a/b.csv'").sources.files.at(0) == "/a/b.csv");
}

TEST_CASE("what is wrong in a study file is named with its line") {
    const auto [text, expected] = GENERATE(table<std::string, std::string>({
        {"tau = 1\ntaus = 1", "folder/my-study.toml:2: unknown key 'taus', did you mean tau?"},
        {"structurs = 'K_L'", ":1: unknown key 'structurs', did you mean structures?"},
        {"tau = 1\nsomething = 1", "folder/my-study.toml:2: unknown key 'something': known are "},
        {"tau = 1\nstructures = K_oV",
         ":2: K_oV is neither a number nor true or false: quote it, 'K_oV'"},
        {"structures = ['x, y', K_oV, 'z'] # = z", ":1: K_oV is neither"},
        {"sources = [\n'x',\nmy file.csv\n]", ":3: my file.csv is neither"},
        {"sources = 2D.csv # two", "quote it, '2D.csv'"},
        {"isotropic = truely", "quote it, 'truely'"},
        {"tau = 1 # K_oV\nb", ":2: Error while parsing key-value pair"},
        {"[[runs]", ":1: Error while parsing table header"},
        {"[[runs]]\nseed = 1", ":2: unknown key 'seed': known are structures, "},
        {"tau = [1", "folder/my-study.toml:1: "},
        {"threads = t\n", "folder/my-study.toml:1: "},
        {"\ntau = 'a'", ":2: tau: 'a' is not a number"},
        {"isotropic = 1", ":1: isotropic: 1 is neither true nor false"},
        {"tau = 1979-05-27", ":1: give numbers, texts"},
        {"tau = [1, [2]]", ":1: give numbers, texts"},
        {"tau = []", ":1: tau: no value"},
        {"tau = 0", ":1: tau: 0 is not positive"},
        {"tau = nan", ":1: tau: nan is not a finite number"},
        {"g_r = 0.9", ":1: g_r: 0.9 is out of range"},
        {"mmg_hgrad = 0.5", ":1: mmg_hgrad: 0.5 is out of range"},
        {"g_r = 1.2\nmmg_hgrad = 1.3", "is the same setting"},
        {"kd_depth = 1.5", "kd_depth: 1.5 is not a whole number"},
        {"voxel = -0.1", "voxel: -0.1 is out of range"},
        {"law = 'cones'", "law: unknown value 'cones': give cone"},
        {"splits = ['s_L', 's_X']", "splits: unknown value 's_X': give s_L"},
        {"schedule = 1", "schedule: 1 is not a text"},
        {"seed = [1, 2]", "seed: 2 values: give 1 at most"},
        {"seed = -1", "seed: -1 is out of range"},
        {"seed = 9223372036854775807", "seed: 9.223372036854776e+18 is out of range"},
        {"threads = 1e9", "threads: 1000000000 is out of range"},
        {"domain = [0, 1]", "domain: give six numbers"},
        {"domain = [0, 1, 0, 1, 1, 0]", "no extent along z"},
        {"domain = [0, 1, 1, 1, 1, 1]", "no extent along two axes"},
        {"fine_probe_grid = 100000", "out of range"},
        {"reference_tolerance = -1e-3", "out of range"},
        {"name = 'a/b'", "cannot name a folder"},
        {"sources = ''", "sources: no name"},
        {"centre = [0, 1]", "centre: give three numbers: x y z"},
        {"sampling = 'even'", "give regular"},
        {"field = 'cube'", "field: unknown value 'cube': give none"},
        {"field_lengths = [0.1, -1]", "field_lengths: -1 is not positive"},
        {"field_lengths = 0.1", "field_lengths: give two numbers: across along"},
        {"field_lengths = [1, 2, 3]", "field_lengths: 3 values: give 2 at most"},
        {"field_growth = -0.1", "field_growth: -0.1 is out of range"},
        {"runs = 1", "give tables [[runs]]"},
        {"runs = []", "give tables [[runs]]"},
    }));
    INFO(text);
    CHECK_THAT(complaint(text), Contains(expected));
    CHECK(complaint(text).find('\n') == std::string::npos);
}

TEST_CASE("keys for surfaces are read") {
    const Study study = parse(
        "sources = 'a.stl'\nsurface_angle = 10\nsurface_crease = 40\nelements_across = 3\n"
        "isotropic = true\nsurface_h_min = 0.1\nsurface_h_max = 2");
    CHECK(study.sources.in_file.curvature == CurvatureSizes{10, 40, 3, true, 0.1, 2});
    CHECK_FALSE(parse("sources = 'a.stl'\nisotropic = false").sources.in_file.curvature.isotropic);
}

TEST_CASE("study files that cannot be read are named") {
    CHECK_THROWS_WITH(read_study("no/such/study.toml"), Contains("no/such/study.toml"));
    CHECK_THROWS_AS(read_study("/"), InputError);
}

TEST_CASE("each parameter gives back what it was set to") {
    const Study defaults;
    for (const auto& p : study_parameters()) {
        const Values values = p.access.get(defaults);
        if (values.empty()) continue;
        Study other;
        other.name = "another";
        set_checked(p.access, other, values);
        CHECK(p.access.get(other) == values);
    }
    for (const auto& p : case_parameters()) {
        INFO(p.key);
        CHECK(p.defaults.empty() == p.is_form());
        for (const Value& value : p.defaults) {
            Case c;
            if (p.key == "kd_depth") c.split = SplitRule::golden;
            set_checked(p.access, c, {value});
            const Values got = p.access.get(c);
            CHECK((got == Values{value} || (got.empty() && value == Value(0))));
        }
    }
}

TEST_CASE("the study files of the project can be read") {
    const std::filesystem::path folder = data_folder() / "studies";
    const Study full = read_study(folder / "paper-sphere.toml", program_parameters());
    REQUIRE(full.runs.size() == 2);
    CHECK(*full.runs[1].find("law") == Values{"mean-length"});
    const Study quick = read_study(folder / "paper-sphere-quick.toml", program_parameters());
    CHECK(quick.runs.size() == 2);
    CHECK(quick.runs[0].structures() == Values{"all"});
    CHECK(read_study(folder / "sources.toml").runs.size() == 3);
    for (const auto& [name, fields] : {std::pair{"fields.toml", 4u}, {"mixtures.toml", 2u}}) {
        const Study study = read_study(folder / name);
        CHECK(study.runs[0].find("field")->size() == fields);
        CHECK(study.domain == Box{Point::Zero(), Point::Ones()});
    }
}

}  // namespace controlspace::study_file_test
