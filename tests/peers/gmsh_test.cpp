// SPDX-License-Identifier: Apache-2.0
// Gmsh's fields as structures: each against its counterpart of the project, which another library
// interpolates.
#include <gmsh.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <filesystem>

#include "case_of_each.h"
#include "controlspace/baselines/catalogue.h"
#include "controlspace/error.h"
#include "controlspace/measure/reference.h"
#include "controlspace/metric/nonconformity.h"
#include "controlspace/sources/riemannian.h"
#include "peers/places.h"

namespace controlspace {
std::vector<CatalogueEntry> gmsh_rows();
std::vector<CatalogueEntry> tets_rows();
}  // namespace controlspace

namespace controlspace::gmsh_test {
namespace {

CatalogueEntry row(const std::vector<CatalogueEntry>& rows, std::string_view id) {
    return *find_entry(rows, id);
}

std::vector<PointSource> sources_in(const Box& box, bool are_layers) {
    std::vector<PointSource> sources;
    for (const Point& x : places_in(box, 80)) {
        const double h = 0.1 + 0.1 * std::abs(x.x() - box.low.x());
        sources.push_back({x, layer_metric(Vector(1, 2, 2) / 3, h, are_layers ? 2 * h : h)});
    }
    return sources;
}

std::unique_ptr<ControlSpace> filled(const CatalogueEntry& entry, const Box& box,
                                     bool has_layers = false, double voxel = 0.1) {
    const auto builder = entry.make({.domain = box, .voxel = voxel});
    builder->insert(sources_in(box, has_layers));
    builder->grade({.schedule = GradationSchedule::queue, .ratio = 1.25});
    return builder->build();
}

/// Largest δ between two structures, in the box and around it.
double difference(const ControlSpace& a, const ControlSpace& b, const Box& box) {
    const Vector margin = Vector::Constant(0.1);
    auto x = places_in({box.low - margin, box.high + margin}, 2000);
    x.push_back(box.low);
    x.push_back(box.high);
    std::vector<Metric> of_a(x.size()), of_b(x.size());
    a.sample(x, of_a);
    b.sample(x, of_b);
    double largest = 0;
    for (std::size_t i = 0; i < x.size(); ++i) {
        CHECK(is_positive_definite(of_a[i]));
        largest = std::max(largest, nonconformity(of_a[i], of_b[i]));
    }
    return largest;
}

TEST_CASE("gmsh-structured answers as uniform-trilinear") {
    const auto structured = row(gmsh_rows(), "gmsh-structured");
    const auto uniform = *find_entry(structures(), "uniform-trilinear");
    CHECK(difference(*filled(structured, oblong), *filled(uniform, oblong), oblong) < 1e-9);
    // Not by chance: another grid answers otherwise.
    const auto coarser = filled(uniform, oblong, false, 0.3);
    CHECK(difference(*filled(structured, oblong), *coarser, oblong) > 1e-3);
    const Box flat{Point(0, 1, 0.3), Point(2, 2, 0.3)};
    CHECK(difference(*filled(structured, flat), *filled(uniform, flat), flat) < 1e-9);
}

TEST_CASE("gmsh-view answers as tets-linear") {
    const auto view = row(gmsh_rows(), "gmsh-view");
    const auto tets = row(tets_rows(), "tets-linear");
    CHECK(difference(*filled(view, oblong), *filled(tets, oblong), oblong) < 1e-6);
    const Box flat{Point(0, 1, 0.3), Point(2, 2, 0.3)};
    CHECK(difference(*filled(view, flat), *filled(tets, flat), flat) < 1e-6);
}

TEST_CASE("gmsh-view of tensors holds M^-2: exact at sources, and linear in it between them") {
    const Box box{Point(0, 0, 0), Point(1, 1, 1)};
    const auto builder = row(gmsh_rows(), "gmsh-view").make({.domain = box});
    const auto layers = sources_in(box, true);
    builder->insert(layers);
    const auto space = builder->build();
    for (const PointSource& source : layers) {
        CHECK(nonconformity(sample_at(*space, source.position), source.metric) < 1e-6);
    }

    auto& nodes = dynamic_cast<NodeBuilder&>(*builder);
    const auto field = [](const Point& x) {
        return *from_riemannian({4 + x.x(), 9 + x.y(), 16, 0.3, 0.2 * x.z(), -0.1});
    };
    std::vector<Metric> metrics;
    for (const Point& x : positions(nodes.control_nodes(Neighbourhood::faces).graph)) {
        metrics.push_back(field(x));
    }
    nodes.assign(metrics);
    const auto assigned = nodes.build();
    for (const Point& x : places_in(box, 500)) {
        CHECK(nonconformity(sample_at(*assigned, x), field(x)) < 1e-6);
    }
}

TEST_CASE("gmsh-view is adapted for what it answers: lengths, or M^-2") {
    const Box box{Point(0, 0, 0), Point(1, 1, 1)};
    const bool has_layers = GENERATE(false, true);
    const auto sources = sources_in(box, has_layers);
    const auto builder = row(gmsh_rows(), "gmsh-view").make({.domain = box});
    AdaptationGoal goal;
    goal.sources = sources;
    goal.target = 0.1;
    CHECK(builder->adapt(goal).met);
    const auto space = builder->build();
    const auto exact = exact_reference(sources, goal.ratio, largest_metric(box));
    for (const Point& x : places_in(box, 2000)) {
        CHECK(nonconformity(sample_at(*space, x), sample_at(*exact, x)) < goal.target);
    }
}

CASE_OF_EACH(entry, gmsh_rows(), "two fields of Gmsh at once") {
    const Box other{Point(-1, -1, -1), Point(0, 0, 0)};
    const auto first = filled(entry, oblong);
    const double before = sample_at(*first, oblong.centre()).xx;
    {
        const auto second = filled(entry, other);
        CHECK(sample_at(*second, other.centre()).xx > 0);
        CHECK(sample_at(*first, oblong.centre()).xx == before);
    }
    CHECK(sample_at(*first, oblong.centre()).xx == before);
    // A mesher's own callback is not asked.
    gmsh::model::add("mesher");
    gmsh::model::mesh::setSizeCallback([](int, int, double, double, double) { return 1e-9; });
    CHECK(sample_at(*first, oblong.centre()).xx == before);
    gmsh::model::mesh::removeSizeCallback();
    std::string current;
    gmsh::model::getCurrent(current);
    CHECK(current == "mesher");
    gmsh::model::remove();
}

CASE_OF_EACH(entry, gmsh_rows(), "sizes are the isotropic metrics' lengths") {
    const auto space = filled(entry, oblong);
    const auto x = places_in(oblong, 200);
    std::vector<double> h(x.size());
    space->sample_lengths(x, h);
    for (std::size_t i = 0; i < x.size(); ++i) CHECK(h[i] == sample_at(*space, x[i]).xx);
}

CASE_OF_EACH(entry, gmsh_rows(), "a field of a Gmsh that was closed throws") {
    const auto closed = filled(entry, oblong);
    gmsh::finalize();
    CHECK_THROWS_WITH(sample_at(*closed, oblong.centre()), Catch::Contains("build the structure"));
    CHECK(sample_at(*filled(entry, oblong), oblong.centre()).xx > 0);
}

TEST_CASE("gmsh-structured refuses tensors, and says what to do") {
    const auto builder = row(gmsh_rows(), "gmsh-structured").make({.domain = oblong, .voxel = 0.1});
    CHECK_THROWS_WITH(builder->insert(sources_in(oblong, true)),
                      Catch::Contains("give isotropic sources"));
}

TEST_CASE("the file that Structured reads is gone once it was read") {
    const auto count = [] {
        const std::filesystem::directory_iterator files(std::filesystem::temp_directory_path());
        return std::ranges::count_if(files, [](const auto& file) {
            return file.path().filename().string().starts_with("controlspace-");
        });
    };
    const auto before = count();
    const auto space = filled(row(gmsh_rows(), "gmsh-structured"), oblong);
    CHECK(count() == before);
}

}  // namespace

}  // namespace controlspace::gmsh_test
