// SPDX-License-Identifier: Apache-2.0
// The answers of every structure to small works, to the bit: data/golden/answers.csv, a checksum
// for each structure, rule of cutting, work and state. To write the table anew, after a change of
// answers that is wanted (the text is for its first line, and says what made it):
//
//   CONTROLSPACE_GOLDEN="commit 0123abc" tests_contract "the table of golden answers is written"
//
// Works are made by sums, products and square roots, which are the same on every processor. The
// library calls std::log, std::exp, std::pow and std::cbrt, whose last bit depends on the
// processor: for tensors without an order and in adaptation to decide when a search ends, and for
// the codes of log16 and log8.
#include <fmt/format.h>

#include <catch2/catch.hpp>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <map>
#include <sstream>

#include "contract/structure_case.h"
#include "controlspace/error.h"
#include "controlspace/fields/analytic_field.h"
#include "controlspace/measure/access_time.h"
#include "controlspace/space/control_space_file.h"
#include "data_folder.h"
#include "editable_space.h"
#include "geometry/random_fractions.h"
#include "scratch_directory.h"

namespace controlspace::answers_test {
namespace {

using Table = std::map<std::string, std::string>;  // by "structure,split,work,state"

struct GoldenWork : Work {
    std::shared_ptr<const ControlSpace> continuous = {};  // of adaptation
};

Metric turned(const std::array<double, 3>& lengths, const Vector& axis) {
    // By a half turn about the axis.
    const Eigen::Matrix3d frame =
        2 * axis * axis.transpose() / axis.squaredNorm() - Eigen::Matrix3d::Identity();
    return metric_from_frame(lengths, frame);
}

Work sphere() {
    Work work{"sphere", {}};
    for (const int face : {0, 1, 2, 3, 4, 5}) {
        for (int i = -2; i <= 2; ++i) {
            for (int j = -2; j <= 2; ++j) {
                Vector v = Vector::Constant(face % 2 == 0 ? 1 : -1);
                v[(face / 2 + 1) % 3] = 0.37 * i;
                v[(face / 2 + 2) % 3] = 0.41 * j;
                v *= 0.6 / std::sqrt(v.squaredNorm());
                work.sources.push_back({v, Metric::isotropic(0.09 + 0.005 * (i + j))});
            }
        }
    }
    return work;
}
Work tensors() {
    Work work{"tensors", {}};
    for (std::size_t i = 0; i < sphere().sources.size(); i += 6) {
        work.sources.push_back(sphere().sources[i]);
    }
    for (PointSource& source : work.sources) {
        const double h = 1.5 * source.metric.xx;
        source.metric = turned({h / 3, h, 1.3 * h}, source.position + Vector(0.1, 0, 0));
    }
    return work;
}
Work own_growths() {
    Work work = sphere();
    work.name = "own growths";
    for (std::size_t i = 0; i < work.sources.size(); ++i) {
        work.sources[i].growth = std::array{0.0, 1.05, 1.8}[i % 3];
    }
    return work;
}
Work flat() {
    Work work{"flat", {}, {Point(-1, 0.3, 2), Point(1.5, 0.3, 3.7)}};
    for (int i = 0; i < 60; ++i) {
        const double t = i / 60.0;
        work.sources.push_back({Point(-0.8 + 2 * t, 0.3, 2.2 + 4.8 * t * (1 - t)),
                                Metric::isotropic(0.05 + 0.05 * t)});
    }
    work.sources.push_back({Point(1.3, 0.3, 2.1), Metric::isotropic(0.17)});
    return work;
}
Work oblong() {
    Work work{"oblong", {}, {Point(1000, -300, 57), Point(1003.7, -298.9, 57.83)}};
    for (int i = 0; i < 12; ++i) {
        for (int j = 0; j < 9; ++j) {
            const double u = 0.082 * i, v = 0.106 * j;
            work.sources.push_back(
                {work.domain.low + Vector(0.31 + u, 0.07 + v, 0.2 + 0.3 * u + 0.2 * v * v),
                 Metric::isotropic(0.08 + 0.03 * u + 0.02 * v * v)});
        }
    }
    work.sources.push_back({work.domain.low + Vector(3.1, 0.2, 0.7), Metric::isotropic(0.11)});
    work.sources.push_back({work.domain.low + Vector(3.6, 1.05, 0.03), Metric::isotropic(0.23)});
    return work;
}
Work oblong_tensors() {
    Work work = oblong();
    work.name = "oblong tensors";
    work.sources.erase(work.sources.begin(), work.sources.begin() + 40);
    for (std::size_t i = 0; i < work.sources.size(); ++i) {
        const double h = work.sources[i].metric.xx;
        work.sources[i].metric =
            turned({h, 1.5 * h, 3 * h}, Vector(1, 0.2 * static_cast<double>(i % 7), -0.6));
    }
    return work;
}
// At random places, on faces of leaves and of the domain, and several at one place.
Work scattered() {
    Work work{"scattered", {}};
    RandomFractions fraction(11);
    for (std::size_t i = 0; i < 80; ++i) {
        Point x(2 * fraction() - 1, 2 * fraction() - 1, 2 * fraction() - 1);
        if (i % 7 == 0) x[static_cast<Axis>(i % 3)] = 0.25 * std::round(4 * x[0]);
        if (i % 11 == 10) x = work.sources[i / 2].position;
        const double share = fraction();
        work.sources.push_back({x, Metric::isotropic(0.06 + 0.8 * share * share)});
    }
    return work;
}
GoldenWork mixed(Work work, const char* name) {
    work.name = name;
    const Point centre = work.domain.centre();
    const auto formula = [centre](const Point& x) {
        const Vector v = x - centre;
        return Metric{0.15 + 0.2 * v.squaredNorm(), 0.3, 0.25 + 0.1 * v.x() * v.x(), 0, 0, 0};
    };
    return {work, function_field(formula, 0.1).field};
}
// Lengths alone.
GoldenWork mixed_lengths() {
    Work work = scattered();
    work.name = "mixed lengths";
    work.sources.resize(20);
    const auto formula = [](const Point& x) {
        return Metric::isotropic(0.2 + 0.2 * (x - Point(0.3, -0.2, 0.1)).squaredNorm());
    };
    return {work, function_field(formula, 0.2).field};
}

std::vector<GoldenWork> golden_works() {
    return {{sphere()},    {tensors()},        {own_growths()},          {flat()},       {oblong()},
            {scattered()}, {oblong_tensors()}, mixed(oblong(), "mixed"), mixed_lengths()};
}

/// Of one structure and work.
class Golden {
public:
    Golden(const CatalogueEntry& structure, const GoldenWork& work, SplitRule split)
        : structure_(structure), work_(work), options_(work.options()) {
        options_.kd_depth = 30;
        options_.octree_depth = 10;
        options_.split = split;
        options_.voxel = work.domain.edges().maxCoeff() / 17;
        const Vector beyond = work.domain.edges() / 16;
        places_ = random_points({work.domain.low - beyond, work.domain.high + beyond}, 700, 7);
        for (std::size_t i = 0; i < work.sources.size(); i += 3) {
            places_.push_back(work.sources[i].position);
        }
    }

    /// Enters each state under `name`.
    void enter(const std::string& name, Table& table) const {
        const auto enter = [&](const std::string& state,
                               const std::function<std::unique_ptr<ControlSpace>()>& make) {
            try {
                table[name + "," + state] = digest(*make());
            } catch (const InputError&) {  // not in the table
            }
        };
        constexpr auto queue = GradationSchedule::queue;
        enter("inserted", [&] { return inserted(options_)->build(); });
        enter("graded", [&] { return graded()->build(); });
        enter("graded by the queue", [&] { return graded({.schedule = queue})->build(); });
        enter("graded by the queue to all", [&] {
            return graded({.schedule = queue, .ratio = 1.1, .neighbourhood = Neighbourhood::all})
                ->build();
        });
        enter("as published", [&] {
            SpaceOptions options = options_;
            options.vertices_in_turn = true;
            options.quadratic_form = QuadraticForm::published;
            const auto builder = inserted(options);
            builder->grade(
                {.law = GradationLaw::mean_length, .schedule = GradationSchedule::passes});
            return builder->build();
        });
        const auto adapted_one = adapted(Precision::doubles);
        enter("adapted", [&] { return adapted_one->build(); });
        enter("adapted then graded", [&] {
            adapted_one->insert(later());
            adapted_one->grade({});
            return adapted_one->build();
        });
        enter("in parts", [&] { return in_parts(false, true)->build(); });
        enter("later", [&] { return in_parts(true, true)->build(); });
        enter("later before gradation", [&] { return in_parts(true, false)->build(); });
        enter("assigned", [&] {
            const auto builder = graded();
            auto* const nodes = dynamic_cast<NodeBuilder*>(builder.get());
            if (nodes == nullptr) throw InputError("no nodes");
            std::vector<Metric> metrics = nodes->control_nodes(Neighbourhood::faces).metrics;
            for (std::size_t i = 0; i < metrics.size(); i += 5) metrics[i] = 0.8 * metrics[i];
            nodes->assign(metrics);
            builder->insert(later());
            builder->grade({});
            return builder->build();
        });
        for (const auto& [state, precision] : precisions) {
            enter(state,
                  [&, precision = precision] { return graded()->build({.precision = precision}); });
        }
        enter("adapted for log8", [&] {
            if (!work_.isotropic()) throw InputError("no codes of tensors");
            return adapted(Precision::log8)->build({.precision = Precision::log8});
        });
        enter("loaded", [&] {
            const ScratchDirectory scratch;
            save_control_space(scratch / "a.ctrl", *graded());
            return load_control_space(scratch / "a.ctrl", structures());
        });
        enter("loaded then graded", [&] {
            const ScratchDirectory scratch;
            save_control_space(scratch / "a.ctrl", *graded());
            const auto builder = load_builder(scratch / "a.ctrl", structures());
            builder->insert(later());
            builder->grade({.ratio = 1.2});
            return builder->build();
        });
        enter("loaded for later", [&] {
            const ScratchDirectory scratch;
            save_control_space(scratch / "a.ctrl", *in_parts(true, false)->build());
            const auto builder = load_builder(scratch / "a.ctrl", structures());
            builder->grade({});
            return builder->build();
        });
        enter("loaded floats", [&] {
            const ScratchDirectory scratch;
            save_control_space(scratch / "a.ctrl", *graded()->build({Precision::floats}));
            return load_control_space(scratch / "a.ctrl", structures());
        });
        if (!structure_.has<VdbFiles>()) return;
        enter("loaded from a .vdb", [&] {
            const ScratchDirectory scratch;
            save_control_space(scratch / "a.vdb", *graded()->build({Precision::floats}));
            return load_control_space(scratch / "a.vdb", structures());
        });
    }

    /// Cells, control nodes, and the checksum of all that it answers.
    std::string digest(const ControlSpace& space) const {
        std::vector<Metric> all(places_.size());
        space.sample(places_, all);
        std::vector<double> lengths(places_.size());
        space.sample_lengths(places_, lengths);
        for (const double h : lengths) all.push_back(Metric::isotropic(h));
        if (const auto nodes = control_nodes(space, Neighbourhood::faces)) {
            all.insert(all.end(), nodes->metrics.begin(), nodes->metrics.end());
        }
        const Footprint footprint = space.footprint();
        return fmt::format("{},{},{:016x}", footprint.cells, footprint.control_nodes,
                           checksum(all));
    }

private:
    static constexpr std::array<std::pair<const char*, Precision>, 4> precisions{
        {{"doubles", Precision::doubles},
         {"floats", Precision::floats},
         {"log16", Precision::log16},
         {"log8", Precision::log8}}};

    std::unique_ptr<ControlSpaceBuilder> inserted(const SpaceOptions& options) const {
        auto builder = structure_.make(options);
        builder->insert(std::span(work_.sources));
        return builder;
    }
    std::unique_ptr<ControlSpaceBuilder> graded(const GradationOptions& gradation = {}) const {
        auto builder = inserted(options_);
        builder->grade(gradation);
        return builder;
    }
    std::unique_ptr<ControlSpaceBuilder> adapted(Precision precision) const {
        SpaceOptions options = options_;
        options.voxel = 0;
        auto builder = structure_.make(options);
        builder->adapt({.sources = work_.sources,
                        .continuous = work_.continuous,
                        .target = work_.isotropic() ? 0.3 : 1.5,
                        .precision = precision,
                        .max_leaves = 1500});
        return builder;
    }
    // Graded after each of three parts; after the last one if it is `finished`.
    std::unique_ptr<ControlSpaceBuilder> in_parts(bool takes_later, bool finished) const {
        SpaceOptions options = options_;
        options.takes_later_sources = takes_later;
        auto builder = structure_.make(options);
        const std::span<const PointSource> all(work_.sources);
        const std::size_t third = all.size() / 3;
        builder->insert(all.first(third));
        builder->grade({});
        builder->insert(all.subspan(third, third));
        builder->grade({});
        builder->insert(all.subspan(2 * third));
        if (finished) builder->grade({});
        return builder;
    }
    std::vector<PointSource> later() const {
        const Box& box = work_.domain;
        return {
            {box.low + Vector(0.55, 0.4, 0.65).cwiseProduct(box.edges()), Metric::isotropic(0.06)}};
    }

    const CatalogueEntry& structure_;
    const GoldenWork& work_;
    SpaceOptions options_;
    std::vector<Point> places_;
};

Table computed(const CatalogueEntry& structure) {
    Table table;
    for (const GoldenWork& work : golden_works()) {
        for (const auto& [split, rule] : {std::pair("s_L", SplitRule::middle),
                                          {"s_G", SplitRule::golden},
                                          {"s_M", SplitRule::metric}}) {
            const bool is_usual = rule == SplitRule::middle;
            if (!is_usual && (!structure.has<SplitRules>() || work.name != "oblong")) continue;
            const char* const name = structure.has<SplitRules>() ? split : "";
            Golden(structure, work, rule)
                .enter(fmt::format("{},{},{}", structure.id, name, work.name), table);
        }
    }
    return table;
}

std::filesystem::path file() { return data_folder() / "golden/answers.csv"; }
constexpr auto names = "structure,split,work,state,cells,control_nodes,checksum";

Table golden(const CatalogueEntry& structure) {
    std::ifstream in(file());
    std::string line;
    std::getline(in, line);  // where the table comes from
    std::getline(in, line);
    REQUIRE(line == names);
    Table table;
    while (std::getline(in, line)) {
        if (!line.starts_with(structure.id + ",")) continue;
        std::size_t end = 0;
        for (int commas = 0; commas < 4; ++commas) end = line.find(',', end + (commas > 0 ? 1 : 0));
        table[line.substr(0, end)] = line.substr(end + 1);
    }
    return table;
}

}  // namespace

STRUCTURE_CASE(every_structure, "answers to the bit as in the golden table", "[long]") {
    const Table expected = golden(structure);
    const Table answers = computed(structure);
    REQUIRE_FALSE(expected.empty());
    for (const auto& [what, answer] : expected) {
        CAPTURE(what);
        if (!answers.contains(what)) FAIL_CHECK("not computed");
        if (answers.contains(what)) CHECK(answers.at(what) == answer);
    }
    CHECK(answers.size() == expected.size());
}

// Saved between later sources and their gradation, when builders kept what sources requested.
TEST_CASE("files of format 5 with later sources are read, and built again") {
    const std::string id = GENERATE("K_V", "uniform-trilinear");
    const CatalogueEntry& structure = *find_entry(structures(), id);
    const auto builder =
        load_builder(data_folder() / ("golden/format-5-" + id + ".ctrl"), structures());
    builder->grade({});
    const GoldenWork work{flat()};
    const std::string split = structure.has<SplitRules>() ? "s_L" : "";
    CHECK(Golden(structure, work, SplitRule::middle).digest(*builder->build()) ==
          golden(structure).at(id + "," + split + ",flat,later"));
}

TEST_CASE("the table of golden answers is written", "[.]") {
    const char* const origin = std::getenv("CONTROLSPACE_GOLDEN");
    REQUIRE(origin != nullptr);
    std::string processor;
    std::ifstream about("/proc/cpuinfo");
    for (std::string line; processor.empty() && std::getline(about, line);) {
        if (line.starts_with("model name")) processor = line.substr(line.find(':') + 2);
    }
    std::ofstream out(file());
    out << "# Made by tests/contract/golden_test.cpp of " << origin << " on " << processor
        << ", compiler " << __VERSION__ << "\n"
        << names << "\n";
    for (const CatalogueEntry& structure : structures()) {
        for (const auto& [what, answer] : computed(structure)) out << what << "," << answer << "\n";
    }
    REQUIRE(out.flush());
}

}  // namespace controlspace::answers_test
