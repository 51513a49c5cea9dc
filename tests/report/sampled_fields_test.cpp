// Structures that are made anew for pictures are those that were measured.
#include "report/sampled_fields.h"

#include <algorithm>
#include <catch2/catch.hpp>

#include "controlspace/metric/nonconformity.h"
#include "report/delta_figures.h"
#include "report/slice_figures.h"
#include "study/run.h"

using namespace controlspace;
using Catch::Matchers::Contains;

namespace {

struct Measured {
    Study study;
    std::vector<Row> rows;
};

Measured measured(double s_n) {
    Measured result;
    Study& study = result.study;
    study.sources.h = 0.2;
    study.access_points = 10;
    study.access_repeats = 1;
    study.probe_grid = 9;
    study.fine_probe_grid = 2;
    study.runs.front().structures = {"K_oL", "K_V"};
    study.runs.front().tau = {1, 0.5};
    study.runs.front().s_n = {s_n};
    PreparedStudy(study, tree_catalogue())
        .run({.case_started = {}, .phase_started = {}, .case_finished = [&](const Row& row) {
                  result.rows.push_back(row);
              }});
    return result;
}

double area(const std::vector<Box>& boxes) {
    double sum = 0;
    for (const Box& b : boxes) sum += b.edges().x() * b.edges().y();
    return sum;
}

}  // namespace

TEST_CASE("of the first setting, each structure is taken once") {
    Measured m = measured(1);
    REQUIRE(m.rows.size() == 8);
    auto chosen = first_setting(m.rows);
    REQUIRE(chosen.size() == 2);
    CHECK(chosen[0] == &m.rows[0]);
    CHECK(structure_label(chosen[1]->setting) == "K_V s_L");
    CHECK(chosen[1]->setting.tau == chosen[0]->setting.tau);
    for (Row& row : m.rows) {
        if (row.setting.tau == 1) row.measures.reset();
    }
    chosen = first_setting(m.rows);
    REQUIRE(chosen.size() == 2);
    CHECK(chosen[0]->setting.tau == 0.5);
    CHECK(first_setting({}).empty());
}

TEST_CASE("a structure made anew answers as the one that was measured") {
    const Measured m = measured(0.5);
    const auto rows = first_setting(m.rows);
    const SampledFields fields = sample_fields(m.study, rows, tree_catalogue(), {});
    REQUIRE(fields.structures.size() == 2);
    CHECK(fields.left_out.empty());
    for (const FieldSample& sample : fields.structures) {
        double largest = 0;
        for (std::size_t i = 0; i < sample.probes.size(); ++i) {
            largest = std::max(largest, nonconformity(sample.probes[i], fields.exact.probes[i]));
        }
        CHECK(largest == Approx(sample.row->measures->accuracy.max).epsilon(1e-12));
        CHECK(largest > 0);
    }
    // The table's brackets are the rows' own numbers.
    for (const auto& row : delta_table(fields).rows) {
        for (std::size_t i = 1; i < row.size(); ++i) {
            const std::string now = row[i].substr(0, row[i].find(' '));
            CHECK(row[i] == now + " (" + now + ")");
        }
    }
}

TEST_CASE("the elements on a slice tile it") {
    const Measured m = measured(1);
    const SampledFields fields =
        sample_fields(m.study, first_setting(m.rows), tree_catalogue(), {});
    for (const FieldSample& sample : fields.structures) {
        REQUIRE(sample.elements);
        CHECK(sample.elements->size() > 20);
        CHECK(area(*sample.elements) == Approx(4));
        for (const Box& e : *sample.elements) CHECK((e.low.z() <= 0 && e.high.z() >= 0));
    }
    const auto space = tree_catalogue()[0].make({.domain = fields.domain});
    CHECK(elements_on_slice(*space, 0.3, 10)->size() == 1);
    CHECK_FALSE(elements_on_slice(*space, 0.3, 0));
}

TEST_CASE("anisotropy is shown where there is any, and only there") {
    for (const double s_n : {1.0, 0.25}) {
        const Measured m = measured(s_n);
        const SampledFields fields =
            sample_fields(m.study, first_setting(m.rows), tree_catalogue(), {});
        const auto figures = slice_figures(fields, "", "a command");
        REQUIRE(figures.size() == 2);
        CHECK((figures[0].data.find("$ratio") != std::string::npos) == (s_n < 1));
        const Figure histograms = delta_histograms(fields, "delta", "");
        CHECK_THAT(histograms.data, Contains("\"K_oL\""));
        // The diagonal, and a pair in both orders.
        const std::string pairs = cross_validation(fields, "pairs", "").data;
        CHECK_THAT(pairs, Contains("\n1 1 0 0\n"));
        const auto at = pairs.find("\n1 2 ") + 5;
        CHECK_THAT(pairs, Contains("\n2 1 " + pairs.substr(at, pairs.find('\n', at) - at)));
    }
}

TEST_CASE("names of structures do not take the room of what is drawn of their pairs") {
    const Measured m = measured(1);
    SampledFields fields = sample_fields(m.study, first_setting(m.rows), tree_catalogue(), {});
    const Figure before = cross_validation(fields, "pairs", "");
    CHECK(before.height > 240);
    Row renamed = *fields.structures.front().row;
    renamed.setting.structure = std::string(60, 'K');
    fields.structures.front().row = &renamed;
    const Figure after = cross_validation(fields, "pairs", "");
    CHECK(after.width - before.width > 2 * 50 * 7);
    CHECK(after.height - before.height > 50 * 4);
}

TEST_CASE("what cannot be made anew is named with its reason") {
    Measured m = measured(1);
    for (Row& row : m.rows) {
        if (row.setting.structure == "K_oL") row.setting.structure = "K_gone";
        if (row.setting.structure == "K_V") row.measures->insert_s = 1e4;
    }
    const SampledFields fields =
        sample_fields(m.study, first_setting(m.rows), tree_catalogue(), {});
    CHECK(fields.structures.empty());
    REQUIRE(fields.left_out.size() == 2);
    CHECK(fields.left_out[0] == "K_gone: this program has no such structure");
    CHECK_THAT(fields.left_out[1], Contains("K_V s_L: took longer than 60 s"));
    CHECK_THROWS_WITH(sample_fields(m.study, {}, tree_catalogue(), {}), Contains("no row has"));
}
